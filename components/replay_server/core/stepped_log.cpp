#include "replay_server/core/stepped_log.h"

#include <optional>
#include <utility>

#include "replay_server/core/log_ports.h"

namespace vismem {
namespace {

class Camera : public FrameSource {
 public:
  explicit Camera(const RobotLog& log) : log_(log) {}

  FrameCapabilities capabilities() const override { return capabilitiesOf(log_); }
  PortReply configure(const FrameRequest& request) override { return configureFor(log_, request); }
  PortReply start() override {
    stopped_ = false;
    return PortReply::accepted();
  }
  FrameResult next(std::chrono::milliseconds) override {
    if (stopped_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
    if (!frame) {
      return finished ? FrameResult{SourceState::kFinished, std::nullopt, "end of " + log_.file()}
                      : FrameResult{SourceState::kWaiting, std::nullopt, "no new frame before the next step"};
    }
    return {SourceState::kRunning, std::exchange(frame, std::nullopt), ""};
  }
  void stop() override { stopped_ = true; }

  std::optional<Frame> frame;
  bool finished = false;

 private:
  const RobotLog& log_;
  bool stopped_ = false;
};

/// The delivered part of a list of samples.
template <typename Sample>
SampleBatch<Sample> released(const std::vector<Sample>& samples, std::size_t count, StampUs after_us) {
  SampleBatch<Sample> batch;
  for (std::size_t i = firstAfter(samples, after_us); i < count; ++i) batch.samples.push_back(samples[i]);
  batch.state = !batch.samples.empty()    ? SourceState::kRunning
                : count == samples.size() ? SourceState::kFinished
                                          : SourceState::kWaiting;
  if (batch.state == SourceState::kFinished) batch.message = "the recording has no more of these samples";
  if (batch.state == SourceState::kWaiting) batch.message = "no newer sample before the next step";
  return batch;
}

class Joints : public PanTiltUnit {
 public:
  explicit Joints(const RobotLog& log) : log_(log) {}

  PanTiltLimits limits() const override { return limitsOf(log_); }
  PortReply start() override { return PortReply::accepted(); }
  PortReply command(const PanTiltCommand& command) override { return ignored(command); }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return released(log_.joints(), count, after_us);
  }
  void stop() override {}

  std::size_t count = 0;

 private:
  const RobotLog& log_;
};

class Base : public MobileBase {
 public:
  explicit Base(const RobotLog& log) : log_(log) {}

  BaseLimits limits() const override { return {}; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply setVelocity(double v_mps, double w_radps) override { return ignoredVelocity(v_mps, w_radps); }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return released(log_.odometry(), count, after_us);
  }
  void stop() override {}

  std::size_t count = 0;

 private:
  const RobotLog& log_;
};

}  // namespace

struct SteppedLog::Impl {
  explicit Impl(RobotLog opened) : log(std::move(opened)), camera(log), joints(log), base(log) {}

  RobotLog log;
  Camera camera;
  Joints joints;
  Base base;
  std::size_t reached = 0;
};

SteppedLog::SteppedLog(RobotLog log) : impl_(std::make_unique<Impl>(std::move(log))) {}
SteppedLog::~SteppedLog() = default;

bool SteppedLog::advanceToNextFrame() {
  const auto& stamps = impl_->log.frameStamps();
  if (impl_->reached == stamps.size()) {
    impl_->camera.frame.reset();
    impl_->camera.finished = true;
    return false;
  }
  const std::size_t index = impl_->reached++;
  impl_->camera.frame = impl_->log.readFrame(index);
  impl_->joints.count = countToCover(impl_->log.joints(), stamps[index]);
  impl_->base.count = countToCover(impl_->log.odometry(), stamps[index]);
  return true;
}

FrameSource& SteppedLog::camera() {
  return impl_->camera;
}
PanTiltUnit& SteppedLog::panTilt() {
  return impl_->joints;
}
MobileBase& SteppedLog::base() {
  return impl_->base;
}
const RobotLog& SteppedLog::log() const {
  return impl_->log;
}

}  // namespace vismem
