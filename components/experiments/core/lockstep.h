/// @file The whole application in one process, without Ice, threads or clocks: the robot moves one frame at a
/// time and everything else follows. The classes are those of the live components. DESIGN 2; SPEC G3, L2.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/profiling/stage_probe.h"
#include "common/robot/observation.h"
#include "common/robot/ports.h"
#include "localization/core/localizer.h"

namespace vismem {

/// Everything about one frame; valid during the call that is given it.
struct LockstepFrame {
  const RobotObservation& observation;
  const AttentiveVisualMemory::StepResult& memory;
  const PoseEstimate& estimate;
};

/// Runs a stepped robot, the visual memory with its gaze, and localization if wanted. The same robot,
/// parameters and seeds give the same results. *Single-threaded*; what it is given must outlive it.
class Lockstep {
 public:
  /// Called for each frame that was processed.
  using Visitor = std::function<void(const LockstepFrame&)>;
  /// Drives the robot: called before each step of time.
  using Driver = std::function<void(MobileBase&)>;

  Lockstep(SteppedRobot& robot, const ObservationAssembler::Params& assembler, MemoryPipeline& memory,
           Localizer& localizer);
  /// Without localization: estimates say nothing.
  Lockstep(SteppedRobot& robot, const ObservationAssembler::Params& assembler, MemoryPipeline& memory);

  /// Hears of the stages "motion", "render", "assemble", those of MemoryPipeline and "localization"; it must
  /// outlive this.
  void setProbe(StageProbe* probe) { probe_ = probe; }
  void setDriver(Driver driver) { driver_ = std::move(driver); }

  /// Moves on by one frame and processes what became complete by it; the gaze's command goes to the pan-tilt
  /// unit. A frame whose moment odometry or joints do not cover is not used (G3) and not visited.
  /// @return false at the end of a log.
  bool step(const Visitor& visit);
  /// Steps to the end, or until a frame's stamp is `duration_us` after the first one's. @return frames
  /// processed.
  std::uint64_t run(const Visitor& visit, std::optional<StampUs> duration_us = std::nullopt);

  std::uint64_t framesProcessed() const { return processed_; }
  std::uint64_t framesDropped() const { return assembler_.droppedFrames(); }
  /// Commands of the gaze that the pan-tilt unit rejected.
  std::uint64_t commandsRejected() const { return rejected_; }

 private:
  void process(const RobotObservation& observation, const Visitor& visit);

  SteppedRobot& robot_;
  ObservationAssembler assembler_;
  MemoryPipeline& memory_;
  Localizer* localizer_;  ///< may be null
  Driver driver_;
  StageProbe* probe_ = nullptr;
  std::optional<StampUs> first_frame_us_;
  StampUs newest_frame_us_ = 0;
  StampUs newest_pan_tilt_us_;
  StampUs newest_odometry_us_;
  Pose2 T_odom_robot_now_;
  std::uint64_t processed_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace vismem
