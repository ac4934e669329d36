/// @file Ports of a calibrated robot: another port's samples and commands with joint scales, wheels and time
/// offsets as `calibrate body` found them.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>

#include "common/kinematics/wheel_correction.h"
#include "common/robot/ports.h"

namespace vismem {

/// A reported angle r, stamped t, stands for the true angle scale * r at t - delay. Zeros belong to the
/// mounting.
struct JointCorrection {
  double pan_scale = 1.0;
  double tilt_scale = 1.0;
  StampUs delay_us = 0;
};

/// Turns true angles and stamps into those that `correction` corrects: for simulated robots.
JointCorrection inverse(const JointCorrection& correction);

/// *Thread-safe* as the unit behind it, which must outlive this.
class CalibratedPanTilt : public PanTiltUnit {
 public:
  CalibratedPanTilt(PanTiltUnit& unit, const JointCorrection& correction)
      : unit_(unit), correction_(correction) {}

  PanTiltLimits limits() const override;
  PortReply start() override { return unit_.start(); }
  PortReply command(const PanTiltCommand& command) override;
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  void stop() override { unit_.stop(); }

 private:
  PanTiltUnit& unit_;
  const JointCorrection correction_;
};

/// Commands pass unchanged; odometry is that of the corrected wheels. *Thread-safe* as the base behind it,
/// which must outlive this, for one reader of samples, who reads forwards.
class CalibratedBase : public MobileBase {
 public:
  CalibratedBase(MobileBase& base, const WheelCorrectionParams& params)
      : base_(base), delay_us_(params.delay_us), correction_(params) {}

  BaseLimits limits() const override { return base_.limits(); }
  PortReply start() override { return base_.start(); }
  PortReply setVelocity(double v_mps, double w_radps) override { return base_.setVelocity(v_mps, w_radps); }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  void stop() override { base_.stop(); }

 private:
  MobileBase& base_;
  const StampUs delay_us_;
  std::mutex mutex_;
  WheelCorrection correction_;
};

/// A stepped robot with calibrated joints and wheels. *Single-threaded*; the robot must outlive it.
class CalibratedRobot : public SteppedRobot {
 public:
  CalibratedRobot(SteppedRobot& robot, const JointCorrection& joints, const WheelCorrectionParams& wheels)
      : robot_(robot), pan_tilt_(robot.panTilt(), joints), base_(robot.base(), wheels) {}

  bool advanceToNextFrame() override { return robot_.advanceToNextFrame(); }
  FrameSource& camera() override { return robot_.camera(); }
  PanTiltUnit& panTilt() override { return pan_tilt_; }
  MobileBase& base() override { return base_; }

 private:
  SteppedRobot& robot_;
  CalibratedPanTilt pan_tilt_;
  CalibratedBase base_;
};

}  // namespace vismem
