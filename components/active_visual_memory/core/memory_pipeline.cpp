#include "active_visual_memory/core/memory_pipeline.h"

#include <utility>

#include "common/vision/reduced_image.h"

namespace vismem {

namespace {

/// With a palette an edge between two places of one colour is a shadow.
AttentiveVisualMemoryParams forPalette(AttentiveVisualMemoryParams params, bool has_palette) {
  const bool by_parallax = params.memory.confirmation.by_parallax;
  if (has_palette && by_parallax) params.memory.confirmation.unlabelled = false;
  return params;
}

}  // namespace

MemoryPipelineParams MemoryPipelineParams::standard() {
  MemoryPipelineParams params{ExtractorParams{}, AttentiveVisualMemoryParams::standard()};
  params.vision.colour_edges = true;
  params.corrects_light = true;
  params.memory.projector.end_short_px = 0.5;  // of the detector `solis`
  return params;
}

MemoryPipelineParams MemoryPipelineParams::chapter() {
  MemoryPipelineParams params{ExtractorParams{}, AttentiveVisualMemoryParams::chapter()};
  params.vision.detector = "chapter";
  return params;
}

MemoryPipeline::MemoryPipeline(const Params& params, std::shared_ptr<const Palette> palette)
    : extractor_(params.vision, palette), memory_(forPalette(params.memory, palette != nullptr)) {
  if (palette && params.corrects_light) light_.emplace(palette);
}

const AttentiveVisualMemory::StepResult& MemoryPipeline::process(const RobotObservation& observation,
                                                                 StageProbe* probe) {
  const CameraIntrinsics& stated = observation.frame.intrinsics;
  const int block = blockSize(stated);
  RobotObservation seen = observation;
  seen.frame.intrinsics = reduced(stated, block);
  if (!memory_.wants(seen)) return memory_.predict(seen, probe);
  if (block > 1) {
    reduceImage(observation.frame.image, stated, block, reduced_);
    seen.frame.image = reduced_;
  }
  const cv::Mat image = seen.frame.image;
  if (correction_) {
    correction_->correct(image, corrected_);
    seen.frame.image = corrected_;
  }
  const auto& segments = extractor_.extract(seen.frame.image, seen.frame.intrinsics, probe);
  if (light_ && light_->update(image, extractor_.detected())) {
    correction_.reset();
    if (!light_->light().isNeutral()) correction_.emplace(light_->light());
  }
  return memory_.update(seen, segments, probe);
}

}  // namespace vismem
