/// @file The memory of a recording against a survey of its floor, along the true way of the robot.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "common/robot/observation.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/app/evaluation.h"
#include "evaluation/core/surveyed_floor.h"
#include "evaluation/core/trajectory.h"

namespace vismem {

/// *Single-threaded*; the truth must outlive it.
class RecordedSurvey {
 public:
  /// @throws ConfigError with the problems of a wrong file.
  RecordedSurvey(const SurveyFiles& files, const Trajectory& truth);

  /// Adds what an image shows. Images without a true pose are left out.
  void add(const RobotObservation& observation);

  /// @return the figures of a memory, or null when its time has no true pose.
  nlohmann::json score(const MemorySnapshot& memory) const;

 private:
  const Trajectory& truth_;
  SurveyedFloor floor_;
  MemoryScoreParams params_;
};

}  // namespace vismem
