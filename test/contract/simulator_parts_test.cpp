// Pan-tilt unit and base of the simulator: in lock-step, and in real time on a thread of its own.
#include "contract/mobile_base_contract.h"
#include "contract/pantilt_contract.h"
#include "simulator/app/real_time_simulation.h"
#include "simulator/core/simulation.h"

namespace vismem::contract {
namespace {

/// Wheels on a bare floor without obstacles, and as little of a camera as there can be.
SimulationConfig onABareFloor() {
  SimulationConfig config;
  config.world.name = "bare floor";
  WorldBody floor;
  floor.name = "floor";
  floor.vertices = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  WorldModel model;
  model.name = "floor";
  model.bodies.push_back(floor);
  config.world.models.push_back(model);
  config.cameras.front().intrinsics = intrinsicsFromFieldOfView(16, 16, degToRad(60.0));
  config.cameras.front().rate_hz = 1.0;
  config.odometry = noOdometryError();
  return config;
}

template <typename Port, typename Robot>
Port& portOf(Robot& robot) {
  if constexpr (std::is_same_v<Port, PanTiltUnit>) {
    return robot.panTilt();
  } else {
    return robot.base();
  }
}

template <typename Port>
class LockStep : public Subject<Port> {
 public:
  Port& port() override { return portOf<Port>(simulation_); }
  void step() override { simulation_.step(); }
  bool isLockStep() const override { return true; }

 private:
  Simulation simulation_{onABareFloor()};
};

template <typename Port>
class RealTime : public Subject<Port> {
 public:
  RealTime() { simulation_.start(); }
  Port& port() override { return portOf<Port>(simulation_); }

 private:
  RealTimeSimulation simulation_{onABareFloor(), 1.0, {}};
};

template <typename Made, typename Port>
std::unique_ptr<Subject<Port>> make() {
  return std::make_unique<Made>();
}

const PanTiltImplementation kLivePanTilt{"RealTime", make<RealTime<PanTiltUnit>, PanTiltUnit>};
const auto kPanTilts = testing::Values(
    kLivePanTilt, PanTiltImplementation{"LockStep", make<LockStep<PanTiltUnit>, PanTiltUnit>});
INSTANTIATE_TEST_SUITE_P(Simulator, PanTiltSamples, kPanTilts, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulator, PanTiltMotion, kPanTilts, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulator, PanTiltThreads, testing::Values(kLivePanTilt), ImplementationName());

const MobileBaseImplementation kLiveBase{"RealTime", make<RealTime<MobileBase>, MobileBase>};
const auto kBases =
    testing::Values(kLiveBase, MobileBaseImplementation{"LockStep", make<LockStep<MobileBase>, MobileBase>});
INSTANTIATE_TEST_SUITE_P(Simulator, MobileBaseSamples, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulator, MobileBaseMotion, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulator, MobileBaseThreads, testing::Values(kLiveBase), ImplementationName());

}  // namespace
}  // namespace vismem::contract
