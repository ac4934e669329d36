/// @file A stepped robot whose camera and odometry are perturbed. See C1.
#pragma once

#include <utility>

#include "common/robot/ports.h"
#include "evaluation/core/perturbation.h"

namespace vismem {

/// Frames of another camera as a perturbed one reports them; those that do not arrive are kWaiting.
class PerturbedCamera : public FrameSource {
 public:
  PerturbedCamera(FrameSource& camera, const Perturbation& perturbation)
      : camera_(camera), perturbation_(perturbation) {}

  FrameCapabilities capabilities() const override { return camera_.capabilities(); }
  PortReply configure(const FrameRequest& request) override { return camera_.configure(request); }
  PortReply start() override { return camera_.start(); }
  void stop() override { camera_.stop(); }
  FrameResult next(std::chrono::milliseconds timeout) override {
    FrameResult result = camera_.next(timeout);
    if (!result.frame) return result;
    if (!arrives(perturbation_, *result.frame))
      return {SourceState::kWaiting, std::nullopt, "an image was lost"};
    result.frame = perturbed(perturbation_, std::move(*result.frame));
    return result;
  }

 private:
  FrameSource& camera_;
  const Perturbation perturbation_;
};

/// A base with the odometry of perturbed wheels.
class PerturbedBase : public MobileBase {
 public:
  PerturbedBase(SteppedRobot& robot, const Perturbation& perturbation) : robot_(robot), odometry_(perturbation) {}

  BaseLimits limits() const override { return robot_.base().limits(); }
  PortReply start() override { return robot_.base().start(); }
  PortReply setVelocity(double v_mps, double w_radps) override { return robot_.base().setVelocity(v_mps, w_radps); }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    SampleBatch<OdometrySample> batch = robot_.base().samplesSince(after_us, timeout);
    for (OdometrySample& sample : batch.samples) sample = odometry_.next(sample);
    return batch;
  }
  void stop() override { robot_.base().stop(); }

 private:
  SteppedRobot& robot_;
  PerturbedOdometry odometry_;
};

/// *Single-threaded*; the robot must outlive it. The odometry is read once, forwards.
class PerturbedRobot : public SteppedRobot {
 public:
  PerturbedRobot(SteppedRobot& robot, const Perturbation& perturbation)
      : robot_(robot), camera_(robot.camera(), perturbation), base_(robot, perturbation) {}

  bool advanceToNextFrame() override { return robot_.advanceToNextFrame(); }
  FrameSource& camera() override { return camera_; }
  PanTiltUnit& panTilt() override { return robot_.panTilt(); }
  MobileBase& base() override { return base_; }

 private:
  SteppedRobot& robot_;
  PerturbedCamera camera_;
  PerturbedBase base_;
};

}  // namespace vismem
