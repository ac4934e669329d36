/// @file From an observation with its image to memory and gaze: what the component and lock-step runs share.
/// Pure. SPEC V1-V6, M1-M6, A1-A6.
#pragma once

#include <memory>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "common/vision/segment_extractor.h"

namespace vismem {

struct MemoryPipelineParams {
  ExtractorParams vision;
  AttentiveVisualMemoryParams memory;

  static MemoryPipelineParams chapter();
  static MemoryPipelineParams standard();
};

/// Extracts the segments of the frames worth analysing (V6) and feeds the memory. *Single-threaded* (owner:
/// the perception loop). Deterministic.
class MemoryPipeline {
 public:
  using Params = MemoryPipelineParams;

  /// @param palette may be null: labels are unknown then.
  /// @throws ConfigError for an unknown detector.
  MemoryPipeline(const Params& params, std::shared_ptr<const Palette> palette);

  /// @throws std::invalid_argument when the image is not of the size its intrinsics say.
  /// @param probe hears of the stages "detect", "label", "memory" and "gaze"; may be null.
  AttentiveVisualMemory::StepResult process(const RobotObservation& observation, StageProbe* probe = nullptr);

  SegmentExtractor& extractor() { return extractor_; }
  AttentiveVisualMemory& memory() { return memory_; }
  const AttentiveVisualMemory& memory() const { return memory_; }

 private:
  SegmentExtractor extractor_;
  AttentiveVisualMemory memory_;
};

}  // namespace vismem
