#include "simulator/core/simulation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/config/text_format.h"
#include "common/robot/command_limits.h"
#include "common/robot/history.h"
#include "simulator/core/scenario_player.h"

namespace vismem {
namespace {

/// Time for which the ports keep samples [us].
constexpr StampUs kKept_us = 5 * kSecondUs;
constexpr double kMaxSlip_m = 1.0;
/// Largest distance of a robot from the origin [m].
constexpr double kFarthest_m = 1000.0;
/// The same at the start, where routes lead [m].
constexpr double kFarthestStart_m = 1.5e5;

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

/// @throws std::invalid_argument.
SimulationConfig checked(SimulationConfig config) {
  if (config.cameras.empty())
    throw std::invalid_argument("simulated robot: no camera (at least one is needed)");
  std::set<std::string> names;
  for (const auto& camera : config.cameras) {
    if (const auto problem = checkCamera(camera); !problem.empty()) {
      throw std::invalid_argument("simulated " + problem);
    }
    if (!names.insert(camera.name).second) {
      throw std::invalid_argument("simulated cameras: two are named \"" + camera.name + "\"");
    }
  }
  return config;
}

}  // namespace

SimulationConfig::SimulationConfig() : T_robot_pantilt(poseFromXyzRpy(0, 0, 0.45, 0, 0, 0)) {}

CameraMount SimulationConfig::mount(std::size_t camera) const {
  return {T_robot_pantilt, cameras.at(camera).T_carrier_camera_body};
}

SimulationConfig humanoidSimulation() {
  SimulationConfig config;
  config.walk = WalkParams{};
  config.T_robot_pantilt = poseFromXyzRpy(0.0, 0.0, 0.39, 0.0, 0.0, 0.0);
  SimulatedCameraParams& camera = config.cameras.front();
  camera.T_carrier_camera_body = poseFromXyzRpy(0.06, 0.0, 0.06, 0.0, 0.0, 0.0);
  camera.reports_pose = true;
  config.pan_tilt.limits = {degToRad(-119.5), degToRad(119.5), degToRad(-29.5),
                            degToRad(38.5),   degToRad(240.0), degToRad(240.0)};
  // It stops when its step is done: 0.2 s and one step of 0.25 s after the last command.
  config.base.limits = {0.25, degToRad(45.0), 0.2};
  config.base.radius_m = 0.15;
  // The feet are 12 cm apart: their slip turns the robot more than the slip of a wheel.
  config.base.wheel_base_m = 0.12;
  config.odometry = noOdometryError();
  config.odometry.radius_sigma = 0.005;
  config.odometry.base_sigma = 0.02;
  config.odometry.travel_sigma_sqrtm = 0.004;
  config.odometry.slips_per_m = 0.2;
  config.odometry.slip_m = 0.01;
  return config;
}

class Simulation::CameraPort : public FrameSource {
 public:
  CameraPort(Simulation& simulation, std::size_t index) : simulation_(simulation), index_(index) {}
  FrameCapabilities capabilities() const override {
    const auto& camera = params();
    return {"simulated camera", camera.intrinsics.width, camera.intrinsics.height, camera.rate_hz,
            camera.reports_pose};
  }
  PortReply configure(const FrameRequest& request) override {
    if (auto rejection = rejectAbsurd(request)) return *rejection;
    const auto& camera = params();
    const bool same = (request.width == 0 || request.width == camera.intrinsics.width) &&
                      (request.height == 0 || request.height == camera.intrinsics.height) &&
                      (request.rate_hz == 0.0 || request.rate_hz == camera.rate_hz);
    return same
               ? PortReply::accepted()
               : PortReply::adjusted("the simulated camera keeps " + std::to_string(camera.intrinsics.width) +
                                     "x" + std::to_string(camera.intrinsics.height) + " at " +
                                     std::to_string(camera.rate_hz) + " Hz");
  }
  PortReply start() override {
    stopped_ = false;
    return PortReply::accepted();
  }
  FrameResult next(std::chrono::milliseconds) override {
    if (stopped_) return {SourceState::kWaiting, std::nullopt, "the camera is stopped"};
    auto frame = simulation_.takeFrame(index_);
    if (!frame) return {SourceState::kWaiting, std::nullopt, "no frame due: simulated time stands still"};
    return {SourceState::kRunning, std::move(frame), ""};
  }
  void stop() override { stopped_ = true; }

 private:
  const SimulatedCameraParams& params() const { return simulation_.config_.cameras[index_]; }

  Simulation& simulation_;
  bool stopped_ = false;
  std::size_t index_;
};

class Simulation::PanTiltPort : public PanTiltUnit {
 public:
  explicit PanTiltPort(Simulation& simulation) : simulation_(simulation) {}
  PanTiltLimits limits() const override { return simulation_.config_.pan_tilt.limits; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply command(const PanTiltCommand& c) override {
    const LimitedPanTiltCommand limited = limitCommand(limits(), c);
    if (limited.reply.ok()) simulation_.pan_tilt_.command(limited.command);
    return limited.reply;
  }
  SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return since(simulation_.pan_tilt_samples_, after_us);
  }
  void stop() override { simulation_.pan_tilt_.halt(); }

 private:
  Simulation& simulation_;
};

class Simulation::BasePort : public MobileBase {
 public:
  explicit BasePort(Simulation& simulation) : simulation_(simulation) {}
  BaseLimits limits() const override { return simulation_.config_.base.limits; }
  PortReply start() override { return PortReply::accepted(); }
  PortReply setVelocity(double v_mps, double w_radps) override {
    const LimitedVelocity limited = limitVelocity(limits(), v_mps, w_radps);
    if (!limited.reply.ok()) return limited.reply;
    simulation_.base_.command(limited.v_mps, limited.w_radps, simulation_.now_us_);
    simulation_.commanded_us_ = simulation_.now_us_;
    return limited.reply;
  }
  SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds) override {
    return since(simulation_.odometry_samples_, after_us);
  }
  void stop() override { simulation_.base_.halt(); }

 private:
  Simulation& simulation_;
};

Simulation::Simulation(SimulationConfig config)
    : config_(checked(std::move(config))),
      scene_(config_.world),
      base_(config_.base, config_.start, {}),
      odometry_(config_.odometry, config_.base.wheel_base_m, 0),
      pan_tilt_(config_.pan_tilt),
      pan_tilt_port_(std::make_unique<PanTiltPort>(*this)),
      base_port_(std::make_unique<BasePort>(*this)),
      reported_pan_tilt_(*pan_tilt_port_, inverse(config_.joints)),
      reported_base_(*base_port_, inverse(config_.wheels)) {
  for (std::size_t i = 0; i < config_.cameras.size(); ++i) {
    camera_ports_.push_back(std::make_unique<CameraPort>(*this, i));
  }
  begin();
}

Simulation::~Simulation() = default;

void Simulation::begin() {
  const std::uint64_t seed = config_.seed;
  renderer_ = std::make_unique<Renderer>(config_.world, config_.rendering);
  shown_ = {};
  scene_ = MovingWorld(config_.world);
  scene_revision_ = scene_.revision();
  base_ = SimulatedBase(config_.base, config_.start, scene_.obstacles());
  if (!isFinite(config_.start) || config_.start.position().norm() > kFarthestStart_m) {
    throw std::invalid_argument("the start pose is not finite, or lies more than 100 km from the origin");
  }
  if (base_.collidesAt(config_.start)) {
    throw std::invalid_argument("the start pose lies inside an obstacle of world \"" + config_.world.name +
                                "\"");
  }
  walk_.reset();
  if (config_.walk) walk_.emplace(*config_.walk, subStream(seed, "walk"));
  odometry_ = SimulatedOdometry(config_.odometry, config_.base.wheel_base_m, subStream(seed, "odometry"));
  pan_tilt_ = SimulatedPanTilt(config_.pan_tilt);
  cameras_.clear();
  for (const auto& camera : config_.cameras)
    cameras_.emplace_back(camera, subStream(seed, "camera " + camera.name));
  taken_.assign(cameras_.size(), std::nullopt);
  now_us_ = 0;
  steps_ = announced_ = 0;
  kidnaps_ = 0;
  commanded_us_.reset();
  pan_tilt_samples_.clear();
  odometry_samples_.clear();
  truth_samples_.clear();
  scenario_problems_.clear();
  if (scenario_) player_ = std::make_unique<ScenarioPlayer>(*scenario_, 0);
  // Includes the state at time 0, at which the first frames are exposed.
  keep(pan_tilt_samples_, PanTiltSample{});
  keep(odometry_samples_, OdometrySample{});
  keep(truth_samples_, truth());
  expose(carriers(), carriers());
}

void Simulation::reset(std::uint64_t seed) {
  config_.seed = seed;
  begin();
}

FrameSource& Simulation::camera(std::size_t index) {
  return *camera_ports_.at(index);
}
PanTiltUnit& Simulation::panTilt() {
  return reported_pan_tilt_;
}
MobileBase& Simulation::base() {
  return reported_base_;
}

Simulation::Carriers Simulation::carriers() const {
  return {base_.pose(), walk_ ? walk_->posture() : BodyPosture{}, pan_tilt_.headAngles()};
}

Pose3 Simulation::believedPose(const SimulatedCameraParams& camera, const Carriers& at) const {
  const Pose3 T_robot_body = bodyPose(at.posture, config_.walk ? config_.walk->known : 1.0);
  if (!camera.on_head) {
    return T_robot_body * cameraPose({camera.T_carrier_camera_body, Pose3::Identity()}, 0.0, 0.0);
  }
  return T_robot_body * cameraPose({config_.T_robot_pantilt, camera.T_carrier_camera_body}, at.neck.pan_rad,
                                   at.neck.tilt_rad);
}

Pose3 Simulation::truePose(const SimulatedCameraParams& camera, const Carriers& at) const {
  const Pose3 T_carrier_true = camera.T_carrier_camera_body * camera.T_believed_true;
  const Pose3 T_body_camera = camera.on_head ? cameraPose({config_.T_robot_pantilt, T_carrier_true},
                                                          at.neck.pan_rad, at.neck.tilt_rad)
                                             : cameraPose({T_carrier_true, Pose3::Identity()}, 0.0, 0.0);
  return toPose3(at.T_world_robot) * bodyPose(at.posture) * T_body_camera;
}

Pose3 Simulation::truePoseOfCamera(std::size_t camera) const {
  return truePose(config_.cameras.at(camera), carriers());
}

void Simulation::expose(const Carriers& before, const Carriers& after) {
  for (SimulatedCamera& camera : cameras_) {
    const StampUs due_us = camera.nextExposure();
    if (due_us > now_us_) continue;
    // The frame's own instant lies inside this step.
    const double fraction = 1.0 - static_cast<double>(now_us_ - due_us) / static_cast<double>(kStep_us);
    const Carriers at{interpolate(before.T_world_robot, after.T_world_robot, fraction),
                      interpolate(before.posture, after.posture, fraction),
                      interpolate(before.neck, after.neck, fraction)};
    ExposedFrame frame;
    frame.T_world_camera = truePose(camera.params(), at);
    if (camera.params().reports_pose) frame.T_robot_camera = believedPose(camera.params(), at);
    frame.scene = scene_.state();
    camera.expose(std::move(frame));
  }
}

void Simulation::step() {
  constexpr double kStep_s = toSeconds(kStep_us);
  if (player_) {
    for (auto& problem : player_->play(*this)) scenario_problems_.push_back(std::move(problem));
  }
  now_us_ += kStep_us;
  ++steps_;
  scene_.step(kStep_s, base_.pose(), config_.base.radius_m);
  noticeObstacles();
  const Carriers before = carriers();
  odometry_.add(walk_ ? base_.moveAt(walk_->step(base_.wanted(now_us_), kStep_s), kStep_s)
                      : base_.step(now_us_, kStep_s));
  pan_tilt_.step(kStep_s);

  const PanTilt angles = pan_tilt_.angles();
  keep(pan_tilt_samples_, PanTiltSample{now_us_, steps_, angles.pan_rad, angles.tilt_rad});
  keep(odometry_samples_, OdometrySample{now_us_, steps_, odometry_.pose(), base_.speed(), base_.turnRate()});
  keep(truth_samples_, truth());
  expose(before, carriers());
}

void Simulation::noticeObstacles() {
  if (scene_revision_ == scene_.revision()) return;
  scene_revision_ = scene_.revision();
  base_.setObstacles(scene_.obstacles());
}

bool Simulation::advanceToNextFrame() {
  for (;;) {
    const ExposedFrame* frame = cameras_.front().arrived(now_us_);
    if (frame != nullptr && frame->seq >= announced_) {
      announced_ = frame->seq + 1;
      return true;
    }
    step();
  }
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
  // Rays from much farther away overflow.
  if (T_world_robot.position().norm() > kFarthest_m) {
    return PortReply::rejected("that place is more than 1000 m from the origin");
  }
  noticeObstacles();
  if (base_.collidesAt(T_world_robot)) return PortReply::rejected("that place is inside an obstacle");
  base_.place({T_world_robot.x, T_world_robot.y, wrapAngle(T_world_robot.theta)});
  if (player_) player_->lost();
  ++kidnaps_;
  return PortReply::accepted();
}

PortReply Simulation::slip(const WheelTravel& extra) {
  if (!(std::abs(extra.left) <= kMaxSlip_m && std::abs(extra.right) <= kMaxSlip_m)) {
    return PortReply::rejected("a slip must be finite and at most 1 m a wheel");
  }
  odometry_.slip(extra);
  return PortReply::accepted();
}

PortReply Simulation::play(Scenario scenario) {
  std::set<std::string> names;
  for (const auto& model : scene_.status()) names.insert(model.name);
  const auto problems = unknownModels(scenario, names);
  if (!problems.empty()) return PortReply::rejected(joined(problems, "\n"));
  player_ = std::make_unique<ScenarioPlayer>(scenario, now_us_);
  scenario_ = std::move(scenario);
  return PortReply::accepted();
}

void Simulation::stopScenario() {
  player_.reset();
  scenario_.reset();
}

std::vector<std::string> Simulation::takeScenarioProblems() {
  return std::exchange(scenario_problems_, {});
}

void Simulation::driveByScenario(double v_mps, double w_radps) {
  const bool by_hand = commanded_us_ && toSeconds(now_us_ - *commanded_us_) <= config_.base.limits.watchdog_s;
  if (!by_hand) base_.command(v_mps, w_radps, now_us_);
}

bool Simulation::frameDue(std::size_t camera) const {
  return cameras_.at(camera).arrived(now_us_) != nullptr;
}

void Simulation::showScene(const ExposedFrame& frame) {
  if (shown_.layout != scene_.layout()) {
    renderer_ = std::make_unique<Renderer>(config_.world, config_.rendering);
    shown_ = {{}, scene_.layout()};
  }
  scene_.show(*frame.scene, *renderer_, shown_);
}

std::optional<Frame> Simulation::takeFrame(std::size_t index) {
  auto exposed = cameras_.at(index).take(now_us_);
  if (!exposed) return std::nullopt;
  showScene(*exposed);
  const SimulatedCamera& camera = cameras_[index];
  const CameraIntrinsics& intrinsics = camera.params().intrinsics;
  Frame frame;
  frame.stamp_us = exposed->stamp_us;
  frame.seq = exposed->seq;
  frame.intrinsics = camera.params().stated_intrinsics.value_or(intrinsics);
  frame.T_robot_camera = exposed->T_robot_camera;
  frame.image = renderer_->render(intrinsics, exposed->T_world_camera);
  camera.errors().apply(frame.image, exposed->seq, exposed->gain);
  taken_[index] = std::move(exposed);
  return frame;
}

std::optional<TruthImages> Simulation::truthImages(std::size_t index) {
  const auto& taken = taken_.at(index);
  if (!taken) return std::nullopt;
  showScene(*taken);
  return renderer_->renderTruth(cameras_[index].params().intrinsics, taken->T_world_camera);
}

}  // namespace vismem
