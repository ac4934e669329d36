#include "simulator/core/simulation.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "simulator/core/renderer.h"

namespace vismem {
namespace {

/// How long the ports keep samples.
constexpr StampUs kKept_us = 5 * kSecondUs;
constexpr std::size_t kNoiseTable = 1 << 18;

template <typename Sample>
SampleBatch<Sample> since(const std::deque<Sample>& kept, StampUs after_us) {
  SampleBatch<Sample> batch;
  for (const auto& sample : kept) {
    if (sample.stamp_us > after_us) batch.samples.push_back(sample);
  }
  if (!batch.samples.empty()) {
    batch.state = SourceState::kRunning;
  } else {
    batch.message = "no newer sample yet: simulated time stands still";
  }
  return batch;
}

template <typename Sample>
void keep(std::deque<Sample>& kept, Sample sample) {
  kept.push_back(std::move(sample));
  while (kept.front().stamp_us + kKept_us < kept.back().stamp_us) kept.pop_front();
}

}  // namespace

SimulationConfig::SimulationConfig() {
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
}

class Simulation::CameraPort : public FrameSource {
 public:
  explicit CameraPort(Simulation& simulation) : simulation_(simulation) {}
  FrameCapabilities capabilities() const override {
    const auto& config = simulation_.config_;
    return {"simulated camera", config.intrinsics.width, config.intrinsics.height, config.camera_rate_hz,
            false};
  }
  PortReply configure(const FrameRequest& request) override {
    if (auto rejection = rejectAbsurd(request)) return *rejection;
    const auto& config = simulation_.config_;
    const bool same = (request.width == 0 || request.width == config.intrinsics.width) &&
                      (request.height == 0 || request.height == config.intrinsics.height) &&
                      (request.rate_hz == 0.0 || request.rate_hz == config.camera_rate_hz);
    return same
               ? PortReply::accepted()
               : PortReply::adjusted("the simulated camera keeps " + std::to_string(config.intrinsics.width) +
                                     "x" + std::to_string(config.intrinsics.height) + " at " +
                                     std::to_string(config.camera_rate_hz) + " Hz");
  }
  PortReply start() override {
    stopped_ = false;
    return PortReply::accepted();
  }
  FrameResult next(std::chrono::milliseconds) override {
    if (stopped_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
    auto frame = simulation_.takeFrame();
    if (!frame) return {SourceState::kWaiting, std::nullopt, "no frame due: simulated time stands still"};
    return {SourceState::kRunning, std::move(frame), ""};
  }
  void stop() override { stopped_ = true; }

 private:
  Simulation& simulation_;
  bool stopped_ = false;
};

class Simulation::PanTiltPort : public PanTiltUnit {
 public:
  explicit PanTiltPort(Simulation& simulation) : simulation_(simulation) {}
  PanTiltLimits limits() const override { return simulation_.config_.pan_tilt.limits; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply command(const PanTiltCommand& c) override {
    if (!std::isfinite(c.pan_rad + c.tilt_rad + c.pan_rate_radps + c.tilt_rate_radps)) {
      return PortReply::rejected("a pan-tilt command must be finite");
    }
    simulation_.pan_tilt_.command(c);
    const PanTiltLimits l = limits();
    const bool inside = c.kind == PanTiltCommand::Kind::kVelocity ||
                        (c.pan_rad >= l.min_pan_rad && c.pan_rad <= l.max_pan_rad &&
                         c.tilt_rad >= l.min_tilt_rad && c.tilt_rad <= l.max_tilt_rad);
    return inside ? PortReply::accepted() : PortReply::adjusted("angles cut to the unit's limits");
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return since(simulation_.pan_tilt_samples_, after_us);
  }
  void stop() override {}

 private:
  Simulation& simulation_;
};

class Simulation::BasePort : public MobileBase {
 public:
  explicit BasePort(Simulation& simulation) : simulation_(simulation) {}
  BaseLimits limits() const override { return simulation_.config_.base.limits; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply setVelocity(double v_mps, double w_radps) override {
    if (!std::isfinite(v_mps + w_radps)) return PortReply::rejected("a velocity must be finite");
    simulation_.base_.command(v_mps, w_radps, simulation_.now_us_);
    const BaseLimits l = limits();
    const bool inside = std::abs(v_mps) <= l.max_speed_mps && std::abs(w_radps) <= l.max_turn_rate_radps;
    return inside ? PortReply::accepted() : PortReply::adjusted("speeds cut to the base's limits");
  }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return since(simulation_.odometry_samples_, after_us);
  }
  void stop() override { simulation_.base_.command(0.0, 0.0, simulation_.now_us_); }

 private:
  Simulation& simulation_;
};

Simulation::Simulation(SimulationConfig config)
    : config_(std::move(config)),
      renderer_(std::make_unique<Renderer>(config_.world)),
      base_(config_.base, config_.start, obstaclesOf(config_.world)),
      odometry_(config_.odometry, config_.base.wheel_base_m, subStream(config_.seed, "odometry")),
      pan_tilt_(config_.pan_tilt),
      camera_port_(std::make_unique<CameraPort>(*this)),
      pan_tilt_port_(std::make_unique<PanTiltPort>(*this)),
      base_port_(std::make_unique<BasePort>(*this)) {
  if (const auto problem = checkIntrinsics(config_.intrinsics); !problem.empty()) {
    throw std::invalid_argument("simulated camera: " + problem);
  }
  if (!(config_.camera_rate_hz > 0.0 && config_.camera_rate_hz <= 100.0)) {
    throw std::invalid_argument("simulated camera: rate " + std::to_string(config_.camera_rate_hz) +
                                " Hz (must be above 0, at most 100)");
  }
  if (!isFinite(config_.start) || base_.collidesAt(config_.start)) {
    throw std::invalid_argument("the start pose lies inside an obstacle of world \"" + config_.world.name +
                                "\"");
  }
  std::mt19937_64 engine(subStream(config_.seed, "image noise"));
  std::normal_distribution<double> normal(0.0, config_.image_noise);
  noise_.resize(kNoiseTable);
  for (auto& value : noise_)
    value = static_cast<std::int8_t>(std::clamp(std::lround(normal(engine)), -127L, 127L));
  // The state at time 0 is known too, and the first frame falls due there.
  keep(pan_tilt_samples_, PanTiltSample{});
  keep(odometry_samples_, OdometrySample{});
  keep(truth_samples_, truth());
  due_frame_ = DueFrame{0, frames_++, toPose3(base_.pose()) * cameraPose(config_.mount, 0.0, 0.0)};
}

Simulation::~Simulation() = default;

FrameSource& Simulation::camera() {
  return *camera_port_;
}
PanTiltUnit& Simulation::panTilt() {
  return *pan_tilt_port_;
}
MobileBase& Simulation::base() {
  return *base_port_;
}

void Simulation::step() {
  constexpr double kStep_s = toSeconds(kStep_us);
  now_us_ += kStep_us;
  ++steps_;
  const Pose2 before = base_.pose();
  const PanTilt angles_before = pan_tilt_.angles();
  odometry_.add(base_.step(now_us_, kStep_s));
  pan_tilt_.step(kStep_s);

  const PanTilt angles = pan_tilt_.angles();
  keep(pan_tilt_samples_, PanTiltSample{now_us_, steps_, angles.pan_rad, angles.tilt_rad});
  keep(odometry_samples_, OdometrySample{now_us_, steps_, odometry_.pose(), base_.speed(), base_.turnRate()});
  keep(truth_samples_, truth());

  const auto due_us = static_cast<StampUs>(static_cast<double>(frames_) * 1e6 / config_.camera_rate_hz);
  if (due_us <= now_us_) {
    // The frame's own instant lies inside this step.
    const double fraction = 1.0 - static_cast<double>(now_us_ - due_us) / static_cast<double>(kStep_us);
    const PanTilt at{angles_before.pan_rad + fraction * (angles.pan_rad - angles_before.pan_rad),
                     angles_before.tilt_rad + fraction * (angles.tilt_rad - angles_before.tilt_rad)};
    due_frame_ = DueFrame{due_us, frames_++,
                          toPose3(interpolate(before, base_.pose(), fraction)) *
                              cameraPose(config_.mount, at.pan_rad, at.tilt_rad)};
  }
}

bool Simulation::advanceToNextFrame() {
  const std::uint64_t wanted = frames_;
  // The very first frame is due at once.
  if (now_us_ == 0 && due_frame_) return true;
  while (frames_ == wanted) step();
  return true;
}

TruthSample Simulation::truth() const {
  return {now_us_, steps_, base_.pose(), base_.inCollision(), kidnaps_};
}

std::vector<TruthSample> Simulation::truthSince(StampUs after_us) const {
  return since(truth_samples_, after_us).samples;
}

void Simulation::advance(StampUs dt_us) {
  for (const StampUs until_us = now_us_ + dt_us; now_us_ < until_us;) step();
}

PortReply Simulation::kidnap(const Pose2& T_world_robot) {
  if (!isFinite(T_world_robot)) return PortReply::rejected("a pose must be finite");
  if (base_.collidesAt(T_world_robot)) return PortReply::rejected("that place is inside an obstacle");
  base_.place(T_world_robot);
  ++kidnaps_;
  return PortReply::accepted();
}

void Simulation::addNoise(cv::Mat& image, std::uint64_t seq) const {
  if (config_.image_noise <= 0.0) return;
  // A table read from another place for every frame: cheap, and the same for the same frame whenever
  // rendered.
  std::size_t at = subStream(config_.seed ^ (seq << 20), "noise of one frame") % kNoiseTable;
  for (std::uint8_t *p = image.data, *end = p + image.total() * image.elemSize(); p != end; ++p) {
    *p = static_cast<std::uint8_t>(std::clamp(*p + noise_[at], 0, 255));
    at = (at + 1) % kNoiseTable;
  }
}

std::optional<Frame> Simulation::takeFrame() {
  if (!due_frame_) return std::nullopt;
  Frame frame;
  frame.stamp_us = due_frame_->stamp_us;
  frame.seq = due_frame_->seq;
  frame.intrinsics = config_.intrinsics;
  frame.image = renderer_->render(config_.intrinsics, due_frame_->T_world_camera);
  addNoise(frame.image, frame.seq);
  due_frame_.reset();
  return frame;
}

}  // namespace vismem
