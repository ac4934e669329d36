#include "evaluation/core/lockstep.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace vismem {
namespace {

constexpr std::chrono::milliseconds kNoWait{0};
constexpr StampUs kNever_us = std::numeric_limits<StampUs>::min() / 2;

}  // namespace

Lockstep::Lockstep(SteppedRobot& robot, const ObservationAssembler::Params& assembler, MemoryPipeline& memory,
                   Localizer* localizer)
    : robot_(robot),
      assembler_(assembler),
      memory_(memory),
      localizer_(localizer),
      newest_pan_tilt_us_(kNever_us),
      newest_odometry_us_(kNever_us) {}

bool Lockstep::step(const Visitor& visit) {
  enterStage(probe_, "motion");
  if (driver_) driver_(robot_.base());
  if (!robot_.advanceToNextFrame()) return false;
  for (const auto& sample : robot_.panTilt().samplesSince(newest_pan_tilt_us_, kNoWait).samples) {
    newest_pan_tilt_us_ = sample.stamp_us;
    assembler_.add(sample);
  }
  for (const auto& sample : robot_.base().samplesSince(newest_odometry_us_, kNoWait).samples) {
    newest_odometry_us_ = sample.stamp_us;
    assembler_.add(sample);
  }
  enterStage(probe_, "render");
  if (FrameResult result = robot_.camera().next(kNoWait); result.frame) {
    newest_frame_us_ = result.frame->stamp_us;
    if (!first_frame_us_) first_frame_us_ = newest_frame_us_;
    assembler_.add(std::move(*result.frame));
  }
  enterStage(probe_, "assemble");
  while (const auto observation = assembler_.take(/*every_frame=*/true)) process(*observation, visit);
  return true;
}

void Lockstep::process(const RobotObservation& observation, const Visitor& visit) {
  const AttentiveVisualMemory::StepResult memory = memory_.process(observation, probe_);
  if (memory.command) robot_.panTilt().command(*memory.command);
  enterStage(probe_, "localization");
  const PoseEstimate estimate = localizer_ ? localizer_->update(memory.update) : PoseEstimate{};
  enterStage(probe_, "report");
  ++processed_;
  if (visit) visit({observation, memory, estimate});
}

std::uint64_t Lockstep::run(const Visitor& visit, std::optional<StampUs> duration_us) {
  const std::uint64_t before = processed_;
  while (step(visit)) {
    if (duration_us && first_frame_us_ && newest_frame_us_ - *first_frame_us_ >= *duration_us) break;
  }
  return processed_ - before;
}

}  // namespace vismem
