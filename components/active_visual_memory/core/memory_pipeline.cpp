#include "active_visual_memory/core/memory_pipeline.h"

#include <utility>

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
  params.memory.projector.end_short_px = 0.5;  // of the detector `solis`
  return params;
}

MemoryPipelineParams MemoryPipelineParams::chapter() {
  MemoryPipelineParams params{ExtractorParams{}, AttentiveVisualMemoryParams::chapter()};
  params.vision.detector = "chapter";
  return params;
}

MemoryPipeline::MemoryPipeline(const Params& params, std::shared_ptr<const Palette> palette)
    : extractor_(params.vision, palette), memory_(forPalette(params.memory, palette != nullptr)) {}

AttentiveVisualMemory::StepResult MemoryPipeline::process(const RobotObservation& observation,
                                                          StageProbe* probe) {
  if (!memory_.wants(observation)) return memory_.predict(observation, probe);
  return memory_.update(
      observation, extractor_.extract(observation.frame.image, observation.frame.intrinsics, probe), probe);
}

}  // namespace vismem
