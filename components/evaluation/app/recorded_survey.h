/// @file The memory and the labels of a recording against a survey of its floor and the map, along the true
/// way of the robot.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "common/robot/observation.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/app/evaluation.h"
#include "evaluation/core/label_check.h"
#include "evaluation/core/surveyed_floor.h"
#include "evaluation/core/trajectory.h"

namespace vismem {

/// *Single-threaded*; the truth must outlive it.
class RecordedSurvey {
 public:
  /// @param map_edges with the true labels, stripes expanded.
  /// @throws ConfigError with the problems of a wrong file.
  RecordedSurvey(const SurveyFiles& files, const SegmentMap& map_edges, const Trajectory& truth);

  /// Adds what an image shows. Images without a true pose are left out.
  /// @param analysis of this image; null: it was not analysed.
  void add(const RobotObservation& observation, const ImageAnalysis* analysis);

  /// @return the figures of a memory, or null when its time has no true pose.
  nlohmann::json score(const MemorySnapshot& memory) const;
  /// @return for each label of the map the length of detected segments on its edges [px], and the shares of
  /// it that were labelled rightly, wrongly, and not at all.
  nlohmann::json labels() const;

 private:
  const Trajectory& truth_;
  SurveyedFloor floor_;
  LabelCheck labels_;
  MemoryScoreParams params_;
};

}  // namespace vismem
