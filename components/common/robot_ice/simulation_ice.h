/// @file A simulated world over Ice: the servant over any SimulationControl, and the client, which is one
/// again.
#pragma once

#include <avm/simulation.h>

#include <memory>
#include <mutex>

#include "common/robot/control_ports.h"
#include "common/robot_ice/remote.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

avm::TruthSample toIce(const TruthSample& sample);
TruthSample fromIce(const avm::TruthSample& sample);
avm::SimulationStatus toIce(const SimulationStatus& status);
SimulationStatus fromIce(const avm::SimulationStatus& status);

/// avm::Simulation. *Thread-safe* over a control that is; it must outlive stop() and the adapter.
class SimulationServant : public avm::Simulation {
 public:
  explicit SimulationServant(SimulationControl& simulation);

  void start() { truth_.start(); }
  void stop() { truth_.stop(); }

  avm::SimulationStatus status(const Ice::Current&) override;
  void truthSinceAsync(Ice::Long after_us, std::function<void(const avm::TruthBatch&)> response,
                       std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::CommandReply kidnap(avm::Pose2 T_world_robot, const Ice::Current&) override;
  avm::CommandReply setPaused(bool paused, const Ice::Current&) override;
  avm::CommandReply setSpeed(double speed, const Ice::Current&) override;

 private:
  SimulationControl& simulation_;
  SampleBroadcaster<TruthSample> truth_;
};

/// A remote simulation as a port. All calls block for at most a second. *Thread-safe.*
class RemoteSimulation : public SimulationControl {
 public:
  explicit RemoteSimulation(const std::shared_ptr<avm::SimulationPrx>& proxy);

  /// As the server said last while it cannot be reached; an empty world before the first time.
  SimulationStatus status() const override;
  SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  PortReply kidnap(const Pose2& T_world_robot) override;
  PortReply pause() override;
  PortReply resume() override;
  PortReply setSpeed(double speed) override;

 private:
  std::shared_ptr<avm::SimulationPrx> proxy_;
  std::shared_ptr<avm::SimulationPrx> commands_;
  PendingCall<avm::TruthBatch> truth_;
  mutable std::mutex mutex_;
  mutable SimulationStatus last_status_;
};

}  // namespace vismem
