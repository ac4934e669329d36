#include "active_visual_memory/core/memory_pipeline.h"

#include <utility>

namespace vismem {

MemoryPipelineParams MemoryPipelineParams::standard() {
  return {ExtractorParams{}, AttentiveVisualMemoryParams::standard()};
}

MemoryPipelineParams MemoryPipelineParams::chapter() {
  MemoryPipelineParams params{ExtractorParams{}, AttentiveVisualMemoryParams::chapter()};
  params.vision.detector = "chapter";
  return params;
}

MemoryPipeline::MemoryPipeline(const Params& params, std::shared_ptr<const Palette> palette)
    : extractor_(params.vision, std::move(palette)), memory_(params.memory) {}

AttentiveVisualMemory::StepResult MemoryPipeline::process(const RobotObservation& observation,
                                                          StageProbe* probe) {
  if (!memory_.wants(observation)) return memory_.glance(observation, probe);
  return memory_.step(
      observation, extractor_.extract(observation.frame.image, observation.frame.intrinsics, probe), probe);
}

}  // namespace vismem
