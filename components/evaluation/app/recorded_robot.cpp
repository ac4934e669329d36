#include "evaluation/app/recorded_robot.h"

#include <utility>

#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/frame_codec.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "recorder/app/file_store.h"
#include "recorder/core/bag_recording.h"
#include "recorder/ice/estimate_messages.h"
#include "recorder/ice/sensor_messages.h"

namespace vismem {
namespace {

constexpr int kJpegQuality = 95;  // of no meaning: pixels are recorded

class RecordedCamera : public FrameSource {
 public:
  RecordedCamera(FrameSource& camera, Emit emit)
      : camera_(camera), emit_(std::move(emit)), messages_("/camera", ImageStorage::kRaw) {}

  FrameCapabilities capabilities() const override { return camera_.capabilities(); }
  PortReply configure(const FrameRequest& request) override { return camera_.configure(request); }
  PortReply start() override { return camera_.start(); }
  void stop() override { camera_.stop(); }
  FrameResult next(std::chrono::milliseconds timeout) override {
    FrameResult result = camera_.next(timeout);
    if (result.frame) {
      const EncodedFrame encoded(*result.frame, kJpegQuality);
      const std::string wrong = messages_.convert(encoded.result(encoded.capturedFormat()).image, emit_);
      if (!wrong.empty()) throw RecordingError(wrong);
    }
    return result;
  }

 private:
  FrameSource& camera_;
  Emit emit_;
  CameraMessages messages_;
};

class RecordedPanTilt : public PanTiltUnit {
 public:
  RecordedPanTilt(PanTiltUnit& unit, Emit emit) : unit_(unit), emit_(std::move(emit)) {}

  PanTiltLimits limits() const override { return unit_.limits(); }
  PortReply start() override { return unit_.start(); }
  PortReply command(const PanTiltCommand& command) override { return unit_.command(command); }
  void stop() override { unit_.stop(); }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    auto batch = unit_.samplesSince(after_us, timeout);
    for (const PanTiltSample& sample : batch.samples) convertPanTilt(toIce(sample), emit_);
    return batch;
  }

 private:
  PanTiltUnit& unit_;
  Emit emit_;
};

class RecordedBase : public MobileBase {
 public:
  RecordedBase(MobileBase& base, Emit emit) : base_(base), emit_(std::move(emit)) {}

  BaseLimits limits() const override { return base_.limits(); }
  PortReply start() override { return base_.start(); }
  PortReply setVelocity(double v_mps, double w_radps) override { return base_.setVelocity(v_mps, w_radps); }
  void stop() override { base_.stop(); }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) override {
    auto batch = base_.samplesSince(after_us, timeout);
    for (const OdometrySample& sample : batch.samples) convertOdometry(toIce(sample), emit_);
    return batch;
  }

 private:
  MobileBase& base_;
  Emit emit_;
};

}  // namespace

struct RecordedRobot::Impl {
  Impl(SteppedRobot& stepped, const std::filesystem::path& folder)
      : robot(stepped),
        store(folder.parent_path(), /*durable=*/false),
        parts(store.create(folder.filename().string())),
        recording({}, *parts),
        camera(robot.camera(), emit()),
        pan_tilt(robot.panTilt(), emit()),
        base(robot.base(), emit()) {}

  Emit emit() {
    return [this](const RecordedMessage& message) { recording.add(message, 0); };
  }

  SteppedRobot& robot;
  FileStore store;
  std::unique_ptr<PartStore> parts;
  BagRecording recording;
  TruthMessages truth;
  RecordedCamera camera;
  RecordedPanTilt pan_tilt;
  RecordedBase base;
};

RecordedRobot::RecordedRobot(SteppedRobot& robot, const std::filesystem::path& folder)
    : impl_(std::make_unique<Impl>(robot, std::filesystem::absolute(folder))) {}
RecordedRobot::~RecordedRobot() = default;

bool RecordedRobot::advanceToNextFrame() {
  return impl_->robot.advanceToNextFrame();
}
FrameSource& RecordedRobot::camera() {
  return impl_->camera;
}
PanTiltUnit& RecordedRobot::panTilt() {
  return impl_->pan_tilt;
}
MobileBase& RecordedRobot::base() {
  return impl_->base;
}

void RecordedRobot::addTruth(const TruthSample& truth) {
  impl_->truth.convert(toIce(truth), impl_->emit());
}

void RecordedRobot::finish() {
  impl_->recording.finish();
}

}  // namespace vismem
