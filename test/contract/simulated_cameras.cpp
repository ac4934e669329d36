// The simulator's camera under the contract of FrameSource: in lock-step and in real time.
#include "contract/frame_source_contract.h"
#include "simulator/app/real_time_simulation.h"
#include "simulator/core/simulation.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

SimulationConfig inRoom() {
  static const World world = loadWorld(VISMEM_SOURCE_DIR "/cfg/worlds/room.world").world;
  SimulationConfig config;
  config.world = world;
  config.cameras.front().intrinsics = intrinsicsFromFieldOfView(64, 48, 1.0);
  config.cameras.front().rate_hz = 20.0;
  return config;
}

class SteppedRig : public FrameSourceRig {
 public:
  FrameSource& source() override { return simulation_.camera(); }
  void provoke() override {
    if (!hushed_) simulation_.advanceToNextFrame();
  }
  void hush() override { hushed_ = true; }
  bool waits() const override { return false; }

 private:
  Simulation simulation_{inRoom()};
  bool hushed_ = false;
};

class RealTimeRig : public FrameSourceRig {
 public:
  RealTimeRig() { simulation_.start(); }
  FrameSource& source() override { return simulation_.camera(); }
  void hush() override { simulation_.pause(); }

 private:
  RealTimeSimulation simulation_{inRoom(), 1.0, {}};
};

INSTANTIATE_TEST_SUITE_P(
    Simulator, FrameSourceContract,
    testing::Values(FrameSourceCase{"lock_step", [](Supply) { return std::make_unique<SteppedRig>(); }},
                    FrameSourceCase{"real_time", [](Supply) { return std::make_unique<RealTimeRig>(); }}),
    nameOfCase);

}  // namespace
}  // namespace vismem
