/// @file From an observation with its image to memory and gaze, for the component and for lock-step runs.
/// Pure. Implements M7. See V1-V6, M1-M10, A1-A6.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "common/vision/light_estimator.h"
#include "common/vision/segment_extractor.h"

namespace vismem {

struct MemoryPipelineParams {
  ExtractorParams vision;
  AttentiveVisualMemoryParams memory;
  bool corrects_light = false;  ///< shows images to detector and memory as under the palette's light (V3)

  static MemoryPipelineParams chapter();
  static MemoryPipelineParams standard();
};

/// Extracts the segments of the frames worth analysing (V6), of fine images after averaging
/// (reduced_image.h), and feeds the memory. Results are in pixels of ImageAnalysis::intrinsics.
/// *Single-threaded* (owner: the perception loop). Deterministic.
class MemoryPipeline {
 public:
  using Params = MemoryPipelineParams;

  /// @param palette may be null: labels are unknown then.
  /// @throws ConfigError for an unknown detector.
  MemoryPipeline(const Params& params, std::shared_ptr<const Palette> palette);

  /// @param probe  is notified of the stages "detect", "label", "memory" and "gaze"; may be null.
  /// @throws std::invalid_argument if the size of the image is not that of its intrinsics.
  /// @return until the next call.
  const AttentiveVisualMemory::StepResult& process(const RobotObservation& observation,
                                                   StageProbe* probe = nullptr);

  SegmentExtractor& extractor() { return extractor_; }
  AttentiveVisualMemory& memory() { return memory_; }
  const AttentiveVisualMemory& memory() const { return memory_; }
  /// The light of the images; null without a palette, and in mode `chapter`.
  const LightEstimator* light() const { return light_ ? &*light_ : nullptr; }

 private:
  SegmentExtractor extractor_;
  AttentiveVisualMemory memory_;
  std::optional<LightEstimator> light_;
  std::optional<LightTable> correction_;  // of a light that is not neutral
  cv::Mat reduced_;
  cv::Mat corrected_;
};

}  // namespace vismem
