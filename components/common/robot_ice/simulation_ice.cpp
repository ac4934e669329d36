#include "common/robot_ice/simulation_ice.h"

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
  return {s.world, static_cast<Ice::Long>(s.seed), s.stamp_us, s.paused, s.speed, s.real_speed};
}

SimulationStatus fromIce(const avm::SimulationStatus& s) {
  return {s.world, static_cast<std::uint64_t>(s.seed), s.stampUs, s.paused, s.speed, s.realSpeed};
}

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
  truth_.whenAfter(after_us, kLongPollWait,
                   [response = std::move(response), exception = std::move(exception)](const auto& batch) {
                     try {
                       avm::TruthBatch answer{toIce(batch.state), batch.message, {}};
                       answer.samples.reserve(batch.samples.size());
                       for (const TruthSample& sample : batch.samples)
                         answer.samples.push_back(toIce(sample));
                       response(answer);
                     } catch (...) {
                       exception(std::current_exception());
                     }
                   });
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

PortReply RemoteSimulation::kidnap(const Pose2& T_world_robot) {
  return runRemote(commands_, "simulation",
                   [&T_world_robot](avm::SimulationPrx& s) { return s.kidnap(toIce(T_world_robot)); });
}

PortReply RemoteSimulation::pause() {
  return runRemote(commands_, "simulation", [](avm::SimulationPrx& s) { return s.setPaused(true); });
}

PortReply RemoteSimulation::resume() {
  return runRemote(commands_, "simulation", [](avm::SimulationPrx& s) { return s.setPaused(false); });
}

PortReply RemoteSimulation::setSpeed(double speed) {
  return runRemote(commands_, "simulation", [speed](avm::SimulationPrx& s) { return s.setSpeed(speed); });
}

}  // namespace vismem
