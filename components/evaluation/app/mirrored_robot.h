/// @file A stepped robot and its double, which gets the same commands. See C1.
#pragma once

#include "common/robot/ports.h"

namespace vismem {

/// The camera of one robot; the double's is read, too.
class MirroredCamera : public FrameSource {
 public:
  MirroredCamera(FrameSource& camera, FrameSource& mirror) : camera_(camera), mirror_(mirror) {}

  FrameCapabilities capabilities() const override { return camera_.capabilities(); }
  PortReply configure(const FrameRequest& request) override {
    mirror_.configure(request);
    return camera_.configure(request);
  }
  PortReply start() override {
    mirror_.start();
    return camera_.start();
  }
  void stop() override {
    mirror_.stop();
    camera_.stop();
  }
  FrameResult next(std::chrono::milliseconds timeout) override {
    mirror_.next(timeout);
    return camera_.next(timeout);
  }

 private:
  FrameSource& camera_;
  FrameSource& mirror_;
};

/// The pan-tilt unit of one robot, whose commands its double obeys, too.
class MirroredPanTilt : public PanTiltUnit {
 public:
  MirroredPanTilt(PanTiltUnit& unit, PanTiltUnit& mirror) : unit_(unit), mirror_(mirror) {}

  PanTiltLimits limits() const override { return unit_.limits(); }
  PortReply start() override {
    mirror_.start();
    return unit_.start();
  }
  PortReply command(const PanTiltCommand& command) override {
    mirror_.command(command);
    return unit_.command(command);
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    mirror_.samplesSince(after_us, timeout);
    return unit_.samplesSince(after_us, timeout);
  }
  void stop() override {
    mirror_.stop();
    unit_.stop();
  }

 private:
  PanTiltUnit& unit_;
  PanTiltUnit& mirror_;
};

/// The base of one robot, whose commands its double obeys, too.
class MirroredBase : public MobileBase {
 public:
  MirroredBase(MobileBase& base, MobileBase& mirror) : base_(base), mirror_(mirror) {}

  BaseLimits limits() const override { return base_.limits(); }
  PortReply start() override {
    mirror_.start();
    return base_.start();
  }
  PortReply setVelocity(double v_mps, double w_radps) override {
    mirror_.setVelocity(v_mps, w_radps);
    return base_.setVelocity(v_mps, w_radps);
  }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    mirror_.samplesSince(after_us, timeout);
    return base_.samplesSince(after_us, timeout);
  }
  void stop() override {
    mirror_.stop();
    base_.stop();
  }

 private:
  MobileBase& base_;
  MobileBase& mirror_;
};

/// What the consumer asks of one robot is asked of its double, too, whose answers do not count: a recording
/// of the double differs by its world alone. *Single-threaded*; both must outlive it.
class MirroredRobot : public SteppedRobot {
 public:
  MirroredRobot(SteppedRobot& robot, SteppedRobot& mirror)
      : robot_(robot),
        mirror_(mirror),
        camera_(robot.camera(), mirror.camera()),
        pan_tilt_(robot.panTilt(), mirror.panTilt()),
        base_(robot.base(), mirror.base()) {}

  bool advanceToNextFrame() override {
    mirror_.advanceToNextFrame();
    return robot_.advanceToNextFrame();
  }
  FrameSource& camera() override { return camera_; }
  PanTiltUnit& panTilt() override { return pan_tilt_; }
  MobileBase& base() override { return base_; }

 private:
  SteppedRobot& robot_;
  SteppedRobot& mirror_;
  MirroredCamera camera_;
  MirroredPanTilt pan_tilt_;
  MirroredBase base_;
};

}  // namespace vismem
