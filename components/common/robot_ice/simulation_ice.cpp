#include "common/robot_ice/simulation_ice.h"

#include <array>
#include <utility>

#include "common/robot_ice/conversions.h"

namespace vismem {

avm::TruthSample toIce(const TruthSample& s) {
  return {s.stamp_us, static_cast<Ice::Long>(s.seq), toIce(s.T_world_robot), s.in_collision,
          static_cast<int>(s.kidnaps)};
}

TruthSample fromIce(const avm::TruthSample& s) {
  return {s.stampUs, static_cast<std::uint64_t>(s.seq), fromIce(s.robotInWorld), s.inCollision,
          static_cast<std::uint32_t>(s.kidnaps)};
}

avm::SimulationStatus toIce(const SimulationStatus& s) {
  return {s.world, static_cast<Ice::Long>(s.seed), s.stamp_us, s.paused, s.speed, s.real_speed, s.lock_step};
}

SimulationStatus fromIce(const avm::SimulationStatus& s) {
  return {s.world, static_cast<std::uint64_t>(s.seed), s.stampUs, s.paused, s.speed, s.realSpeed, s.lockStep};
}

avm::PropShape toIce(const PropShape& s) {
  constexpr std::array kKinds{avm::PropKind::PropBox, avm::PropKind::PropCylinder, avm::PropKind::PropRobot};
  return {kKinds[static_cast<std::size_t>(s.kind)], toIce(s.size_m), toIce(s.color)};
}

PropShape fromIce(const avm::PropShape& s) {
  PropShape shape;
  if (s.kind == avm::PropKind::PropCylinder) shape.kind = PropShape::Kind::kCylinder;
  if (s.kind == avm::PropKind::PropRobot) shape.kind = PropShape::Kind::kRobot;
  shape.size_m = fromIce(s.size);
  shape.color = fromIce(s.color);
  return shape;
}

avm::ModelStatus toIce(const ModelStatus& s) {
  return {s.name, toIce(s.T_world_model), s.present, s.walking};
}

ModelStatus fromIce(const avm::ModelStatus& s) {
  return {s.name, fromIce(s.modelInWorld).value_or(Pose3::Identity()), s.present, s.walking};
}

avm::Way toIce(const Way& w) {
  avm::Way way{{}, w.closed, w.at_end == WayEnd::kStand, w.speed_mps};
  for (const auto& point : w.points) way.points.push_back(toIce(point));
  return way;
}

Way fromIce(const avm::Way& w) {
  Way way{{}, w.closed, w.standAtEnd ? WayEnd::kStand : WayEnd::kBack, w.speedMps};
  for (const auto& point : w.points) way.points.push_back(fromIce(point));
  return way;
}

namespace {

Pose3 requirePose(const char* name, const avm::Pose3& pose) {
  const auto valid = fromIce(pose);
  if (!valid) {
    throw avm::InvalidArgument(std::string(name) + " (must be finite, with a quaternion of unit length)");
  }
  return *valid;
}

}  // namespace

SimulationServant::SimulationServant(SimulationControl& simulation)
    : simulation_(simulation), truth_([&simulation](StampUs after_us, std::chrono::milliseconds timeout) {
        return simulation.truthSince(after_us, timeout);
      }) {}

avm::SimulationStatus SimulationServant::status(const Ice::Current&) {
  return toIce(simulation_.status());
}

void SimulationServant::truthSinceAsync(Ice::Long after_us,
                                        std::function<void(const avm::TruthBatch&)> response,
                                        std::function<void(std::exception_ptr)> exception,
                                        const Ice::Current&) {
  answerSamples(truth_, after_us, std::move(response), std::move(exception));
}

avm::CommandReply SimulationServant::kidnap(avm::Pose2 T_world_robot, const Ice::Current&) {
  requireFinite("robotInWorld.x", T_world_robot.x);
  requireFinite("robotInWorld.y", T_world_robot.y);
  requireFinite("robotInWorld.theta", T_world_robot.theta);
  return toIce(simulation_.kidnap(fromIce(T_world_robot)));
}

avm::CommandReply SimulationServant::setPaused(bool paused, const Ice::Current&) {
  return toIce(paused ? simulation_.pause() : simulation_.resume());
}

avm::CommandReply SimulationServant::setSpeed(double speed, const Ice::Current&) {
  requireInRange("speed", speed, 0.01, 1000.0);
  return toIce(simulation_.setSpeed(speed));
}

avm::CommandReply SimulationServant::step(int steps, const Ice::Current&) {
  requireInRange("steps", steps, 1, 1000);
  return toIce(simulation_.step(steps));
}

avm::CommandReply SimulationServant::setLockStep(int consumers, const Ice::Current&) {
  requireInRange("consumers", consumers, 0, 64);
  return toIce(simulation_.setLockStep(consumers));
}

avm::CommandReply SimulationServant::reset(Ice::Long seed, const Ice::Current&) {
  if (seed < 0) throw avm::InvalidArgument("seed = " + std::to_string(seed) + " (must be 0 or more)");
  return toIce(simulation_.reset(static_cast<std::uint64_t>(seed)));
}

avm::ModelStatusSeq SimulationServant::models(const Ice::Current&) {
  avm::ModelStatusSeq result;
  for (const auto& model : simulation_.models()) result.push_back(toIce(model));
  return result;
}

avm::CommandReply SimulationServant::addModel(std::string name, avm::PropShape shape, avm::Pose3 pose,
                                              const Ice::Current&) {
  return toIce(simulation_.addModel(name, fromIce(shape), requirePose("modelInWorld", pose)));
}

avm::CommandReply SimulationServant::removeModel(std::string name, const Ice::Current&) {
  return toIce(simulation_.removeModel(name));
}

avm::CommandReply SimulationServant::placeModel(std::string name, avm::Pose3 pose, const Ice::Current&) {
  return toIce(simulation_.placeModel(name, requirePose("modelInWorld", pose)));
}

avm::CommandReply SimulationServant::walkModel(std::string name, avm::Way way, const Ice::Current&) {
  return toIce(simulation_.walkModel(name, fromIce(way)));
}

avm::CommandReply SimulationServant::standModel(std::string name, const Ice::Current&) {
  return toIce(simulation_.standModel(name));
}

avm::CommandReply SimulationServant::slip(double left_m, double right_m, const Ice::Current&) {
  requireInRange("leftM", left_m, -1.0, 1.0);
  requireInRange("rightM", right_m, -1.0, 1.0);
  return toIce(simulation_.slip(left_m, right_m));
}

avm::CommandReply SimulationServant::playScenario(std::string text, const Ice::Current&) {
  return toIce(simulation_.playScenario(text));
}

RemoteSimulation::RemoteSimulation(const std::shared_ptr<avm::SimulationPrx>& proxy)
    : proxy_(boundedProxy(proxy, kInvocationTimeout_ms)),
      commands_(boundedProxy(proxy, kCommandTimeout_ms)),
      truth_(proxy_) {}

SimulationStatus RemoteSimulation::status() const {
  std::optional<SimulationStatus> now;
  try {
    if (commands_) now = fromIce(commands_->status());
  } catch (const Ice::Exception&) {
    // The last known status is the answer, as the header says.
    now.reset();
  }
  const std::lock_guard lock(mutex_);
  if (now) last_status_ = *now;
  return last_status_;
}

SampleBatch<TruthSample> RemoteSimulation::truthSince(StampUs after_us, std::chrono::milliseconds timeout) {
  return pollRemoteSamples<TruthSample>(
      truth_, after_us, timeout,
      [this, after_us](auto done, auto failed) {
        proxy_->truthSinceAsync(after_us, std::move(done), std::move(failed));
      },
      [](const avm::TruthSample& sample) { return fromIce(sample); });
}

template <typename Call>
PortReply RemoteSimulation::command(Call&& call) {
  return runRemote(commands_, "simulation", std::forward<Call>(call));
}

PortReply RemoteSimulation::kidnap(const Pose2& T_world_robot) {
  return command([&](avm::SimulationPrx& s) { return s.kidnap(toIce(T_world_robot)); });
}

PortReply RemoteSimulation::pause() {
  return command([](avm::SimulationPrx& s) { return s.setPaused(true); });
}

PortReply RemoteSimulation::resume() {
  return command([](avm::SimulationPrx& s) { return s.setPaused(false); });
}

PortReply RemoteSimulation::setSpeed(double speed) {
  return command([&](avm::SimulationPrx& s) { return s.setSpeed(speed); });
}

PortReply RemoteSimulation::step(int steps) {
  return command([&](avm::SimulationPrx& s) { return s.step(steps); });
}

PortReply RemoteSimulation::setLockStep(int consumers) {
  return command([&](avm::SimulationPrx& s) { return s.setLockStep(consumers); });
}

PortReply RemoteSimulation::reset(std::uint64_t seed) {
  return command([&](avm::SimulationPrx& s) { return s.reset(static_cast<Ice::Long>(seed)); });
}

std::vector<ModelStatus> RemoteSimulation::models() {
  std::vector<ModelStatus> result;
  try {
    if (!commands_) return result;
    for (const auto& model : commands_->models()) result.push_back(fromIce(model));
  } catch (const Ice::Exception&) {
    // Empty while the server cannot be reached, as declared in the header.
    result.clear();
  }
  return result;
}

PortReply RemoteSimulation::addModel(const std::string& name, const PropShape& shape,
                                     const Pose3& T_world_model) {
  return command([&](avm::SimulationPrx& s) { return s.addModel(name, toIce(shape), toIce(T_world_model)); });
}

PortReply RemoteSimulation::removeModel(const std::string& name) {
  return command([&](avm::SimulationPrx& s) { return s.removeModel(name); });
}

PortReply RemoteSimulation::placeModel(const std::string& name, const Pose3& T_world_model) {
  return command([&](avm::SimulationPrx& s) { return s.placeModel(name, toIce(T_world_model)); });
}

PortReply RemoteSimulation::walkModel(const std::string& name, const Way& way) {
  return command([&](avm::SimulationPrx& s) { return s.walkModel(name, toIce(way)); });
}

PortReply RemoteSimulation::standModel(const std::string& name) {
  return command([&](avm::SimulationPrx& s) { return s.standModel(name); });
}

PortReply RemoteSimulation::slip(double left_m, double right_m) {
  return command([&](avm::SimulationPrx& s) { return s.slip(left_m, right_m); });
}

PortReply RemoteSimulation::playScenario(const std::string& text) {
  return command([&](avm::SimulationPrx& s) { return s.playScenario(text); });
}

}  // namespace vismem
