/// @file A simulated robot, its memory and a mapper as processes: time waits for all of them.
#pragma once

#include <Ice/Ice.h>
#include <avm/mapper.h>
#include <avm/simulation.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/build_paths.h"
#include "support/component_process.h"
#include "support/eventually.h"
#include "support/ice_client.h"
#include "support/temporary_folder.h"

namespace vismem {

/// The argument that reads the configuration of a component of the simulated robot.
inline std::string simConfiguration(const std::string& name) {
  return "--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/sim/" + name + ".cfg";
}

class LiveMapper {
 public:
  struct Drive {
    std::string world;  ///< cfg/worlds/NAME.world, cfg/maps/NAME.palette
    std::string start;  ///< of the robot: "x y" [m]
    std::string heading_deg;
    std::string way;  ///< as in a scenario: "way=open points_m=3,2.25;-3,2.25"
    int seed = 3;
  };

  LiveMapper(const TemporaryFolder& folder, const Drive& drive) {
    const std::string palette = VISMEM_SOURCE_DIR "/cfg/maps/" + drive.world + ".palette";
    std::ofstream(folder / "drive.scenario") << "scenario 1\nat 0 drive speed_mps=0.3 " << drive.way << "\n";
    simulator_ = startComponent(
        "simulator",
        {simConfiguration("simulator"), "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0",
         "--Simulator.World=cfg/worlds/" + drive.world + ".world",
         "--Simulator.Start.Position_m=" + drive.start, "--Simulator.Start.Heading_deg=" + drive.heading_deg,
         "--Simulator.Paused=yes", "--Simulator.Seed=" + std::to_string(drive.seed),
         "--Simulator.Camera.Rate_hz=10", "--Simulator.Scenario=" + (folder / "drive.scenario")});
    memory_ = startComponent(
        "active_visual_memory",
        {simConfiguration("active_visual_memory"), "--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 0",
         "--ActiveVisualMemory.Palette=" + palette,
         "--ActiveVisualMemory.Camera.Proxy=" + simulator_->proxy("cameraA"),
         "--ActiveVisualMemory.PanTilt.Proxy=" + simulator_->proxy("PanTilt"),
         "--ActiveVisualMemory.Odometry.Proxy=" + simulator_->proxy("Encoders")});
    mapper_ = startComponent(
        "mapper",
        {simConfiguration("mapper"), "--Mapper.Endpoints=tcp -h 127.0.0.1 -p 0",
         "--Mapper.Palette=" + palette, "--Mapper.VisualMemory.Proxy=" + memory_->proxy("VisualMemory"),
         "--Mapper.Camera.Proxy=" + simulator_->proxy("cameraA"), "--Mapper.Folder=" + (folder / "maps")});
    control_ = ice_.find<avm::MapperPrx>(*mapper_, "Mapper");
    simulation_ = ice_.find<avm::SimulationPrx>(*simulator_, "Simulation");
  }

  ComponentProcess& simulator() { return *simulator_; }
  ComponentProcess& mapper() { return *mapper_; }
  avm::MapperPrx& control() { return *control_; }
  IceClient& ice() { return ice_; }

  /// @param readers  of images: memory, mapper and others. Time waits for them.
  void driveUntil(double way_m, int readers = 2, std::chrono::seconds patience = kPatience) {
    simulation_->setLockStep(readers);
    simulation_->setPaused(false);
    EXPECT_TRUE(eventually([&] { return control_->status().wayM >= way_m; }, patience))
        << control_->status().message;
    simulation_->setLockStep(0);
    simulation_->setPaused(true);
  }
  /// @param name as of avm::Mapper::build.
  avm::MapReport built(const std::string& name) {
    const int before = control_->status().built;
    control_->build(name);
    EXPECT_TRUE(eventually([&] { return control_->status().built > before; }));
    return control_->status().last;
  }

 private:
  IceClient ice_;
  std::unique_ptr<ComponentProcess> simulator_;
  std::unique_ptr<ComponentProcess> memory_;
  std::unique_ptr<ComponentProcess> mapper_;
  std::shared_ptr<avm::MapperPrx> control_;
  std::shared_ptr<avm::SimulationPrx> simulation_;
};

}  // namespace vismem
