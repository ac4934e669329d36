/// @file Robot, memory and localization in one process, frame by frame, without Ice, threads or clocks. The
/// classes are those of the live components. See G3, L2.
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

/// One processed frame; valid during the visitor's call.
struct LockstepFrame {
  const RobotObservation& observation;
  const AttentiveVisualMemory::StepResult& memory;
  const PoseEstimate& estimate;
};

/// Runs a stepped robot, the visual memory with its gaze, and optionally localization. The same robot,
/// parameters and seeds give the same results. *Single-threaded*; constructor arguments must outlive it.
class Lockstep {
 public:
  /// Called after each processed frame.
  using Visitor = std::function<void(const LockstepFrame&)>;
  /// Drives the robot: called before each frame's time step.
  using Driver = std::function<void(MobileBase&)>;

  /// @param localizer null: estimates are empty.
  Lockstep(SteppedRobot& robot, const ObservationAssembler::Params& assembler, MemoryPipeline& memory,
           Localizer* localizer = nullptr);

  /// Receives the stages "motion", "render", "assemble", those of MemoryPipeline and "localization".
  /// @param probe must outlive this.
  void setProbe(StageProbe* probe) { probe_ = probe; }
  void setDriver(Driver driver) { driver_ = std::move(driver); }

  /// Advances the robot by one frame, processes the observations that are now complete, and sends the gaze's
  /// command to the pan-tilt unit. A frame outside the known history of odometry or joints is dropped (G3).
  /// @return false at the end of a log.
  bool step(const Visitor& visit);
  /// Steps to the end, or until a frame's stamp is `duration_us` after the first one's.
  /// @return frames processed.
  std::uint64_t run(const Visitor& visit, std::optional<StampUs> duration_us = std::nullopt);

  std::uint64_t framesProcessed() const { return processed_; }
  std::uint64_t framesDropped() const { return assembler_.droppedFrames(); }

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
  std::uint64_t processed_ = 0;
};

}  // namespace vismem
