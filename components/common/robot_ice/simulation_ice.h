/// @file A simulated world over Ice: the servant of a SimulationControl, and a client that implements
/// SimulationControl.
#pragma once

#include <avm/simulation.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/robot/control_ports.h"
#include "common/robot_ice/remote.h"
#include "common/robot_ice/sample_broadcaster.h"

namespace vismem {

avm::TruthSample toIce(const TruthSample& sample);
TruthSample fromIce(const avm::TruthSample& sample);
avm::SimulationStatus toIce(const SimulationStatus& status);
SimulationStatus fromIce(const avm::SimulationStatus& status);
avm::PropShape toIce(const PropShape& shape);
PropShape fromIce(const avm::PropShape& shape);
avm::ModelStatus toIce(const ModelStatus& status);
/// An invalid pose becomes the identity.
ModelStatus fromIce(const avm::ModelStatus& status);
avm::Way toIce(const Way& way);
Way fromIce(const avm::Way& way);

/// Serves avm::Simulation. *Thread-safe* for a thread-safe control, which must outlive stop() and the
/// adapter.
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
  avm::CommandReply step(int steps, const Ice::Current&) override;
  avm::CommandReply setLockStep(int consumers, const Ice::Current&) override;
  avm::CommandReply reset(Ice::Long seed, const Ice::Current&) override;
  avm::ModelStatusSeq models(const Ice::Current&) override;
  avm::CommandReply addModel(std::string name, avm::PropShape shape, avm::Pose3 pose,
                             const Ice::Current&) override;
  avm::CommandReply removeModel(std::string name, const Ice::Current&) override;
  avm::CommandReply placeModel(std::string name, avm::Pose3 pose, const Ice::Current&) override;
  avm::CommandReply walkModel(std::string name, avm::Way way, const Ice::Current&) override;
  avm::CommandReply standModel(std::string name, const Ice::Current&) override;
  avm::CommandReply slip(double left_m, double right_m, const Ice::Current&) override;
  avm::CommandReply playScenario(std::string text, const Ice::Current&) override;

 private:
  SimulationControl& simulation_;
  SampleBroadcaster<TruthSample> truth_;
};

/// A remote simulation as a port. All calls block for at most a second. *Thread-safe.*
class RemoteSimulation : public SimulationControl {
 public:
  explicit RemoteSimulation(const std::shared_ptr<avm::SimulationPrx>& proxy);

  /// The last status from the server; an empty world before the first answer.
  SimulationStatus status() const override;
  SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds timeout) override;
  PortReply kidnap(const Pose2& T_world_robot) override;
  PortReply pause() override;
  PortReply resume() override;
  PortReply setSpeed(double speed) override;
  PortReply step(int steps) override;
  PortReply setLockStep(int consumers) override;
  PortReply reset(std::uint64_t seed) override;
  /// Empty while the server cannot be reached.
  std::vector<ModelStatus> models() override;
  PortReply addModel(const std::string& name, const PropShape& shape, const Pose3& T_world_model) override;
  PortReply removeModel(const std::string& name) override;
  PortReply placeModel(const std::string& name, const Pose3& T_world_model) override;
  PortReply walkModel(const std::string& name, const Way& way) override;
  PortReply standModel(const std::string& name) override;
  PortReply slip(double left_m, double right_m) override;
  PortReply playScenario(const std::string& text) override;

 private:
  template <typename Call>
  PortReply command(Call&& call);

  std::shared_ptr<avm::SimulationPrx> proxy_;
  std::shared_ptr<avm::SimulationPrx> commands_;
  PendingCall<avm::TruthBatch> truth_;
  mutable std::mutex mutex_;
  mutable SimulationStatus last_status_;
};

}  // namespace vismem
