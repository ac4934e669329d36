#include "application/app/robot_link.h"

#include <avm/component.h>

#include <thread>

#include "common/memory_ice/gaze_ice.h"
#include "common/memory_ice/visual_memory_ice.h"
#include "common/process/ice_setup.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/replay_ice.h"
#include "common/robot_ice/simulation_ice.h"
#include "localization/ice/localization_ice.h"

namespace vismem {

RobotLink::RobotLink(const RunOptions& options, const Launcher& launcher)
    : log_("run_application", LogLevel::kWarning), communicator_(makeCommunicator(Properties{}, log_)) {
  const bool simulated = options.setup == Setup::kSimulation;
  const std::string robot = simulated ? "simulator" : "replay_server";
  const std::string memory = "active_visual_memory";
  const auto proxy = [&](const std::string& component, const std::string& identity) {
    return communicator_->stringToProxy(launcher.proxy(component, identity));
  };
  camera_ = std::make_unique<RemoteFrameSource>(Ice::uncheckedCast<avm::CameraPrx>(proxy(robot, "cameraA")));
  base_ = std::make_unique<RemoteMobileBase>(
      simulated ? Ice::uncheckedCast<avm::BasePrx>(proxy(robot, "Motors")) : nullptr,
      Ice::uncheckedCast<avm::OdometryPrx>(proxy(robot, "Encoders")));
  if (simulated) {
    simulation_ = std::make_unique<RemoteSimulation>(
        Ice::uncheckedCast<avm::SimulationPrx>(proxy(robot, "Simulation")));
  } else {
    replay_ = std::make_unique<RemoteReplay>(Ice::uncheckedCast<avm::ReplayPrx>(proxy(robot, "Replay")));
  }
  memory_ = std::make_unique<VisualMemoryClient>(
      Ice::uncheckedCast<avm::VisualMemoryPrx>(proxy(memory, "VisualMemory")));
  gaze_ = std::make_unique<RemoteGaze>(Ice::uncheckedCast<avm::GazePrx>(proxy(memory, "Gaze")));
  localization_ = std::make_unique<RemoteLocalization>(
      Ice::uncheckedCast<avm::LocalizationPrx>(proxy("localization", "Localization")));
  std::vector<std::string> names{"active_visual_memory", "localization"};
  if (options.record) {
    names.emplace_back("recorder");
    recorder_ =
        Ice::uncheckedCast<avm::RecorderPrx>(proxy("recorder", "Recorder")->ice_invocationTimeout(1000));
  }
  for (const std::string& name : names) status_proxies_.push_back(launcher.proxy(name, name + "/component"));
}

std::string RobotLink::recordingFailure() const {
  if (!recorder_) return "";
  try {
    const avm::RecorderStatus status = recorder_->status();
    return status.state == avm::RecorderState::Failed ? status.message : "";
  } catch (const Ice::Exception& failure) {
    return std::string("recorder: ") + failure.what();
  }
}

std::string RobotLink::waitForPeers(std::chrono::seconds timeout, const std::function<bool()>& interrupted) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  std::string missing;
  while (!interrupted()) {
    missing.clear();
    for (const std::string& text : status_proxies_) {
      try {
        const auto component = Ice::uncheckedCast<avm::ComponentPrx>(
            communicator_->stringToProxy(text)->ice_invocationTimeout(1000));
        const avm::ComponentStatus status = component->getStatus();
        for (const avm::PeerStatus& peer : status.peers) {
          if (!peer.connected)
            missing += status.name + " waits for " + peer.name + " at " + peer.proxy + "; ";
        }
      } catch (const Ice::Exception& failure) {
        missing += text + ": " + failure.what() + "; ";
      }
    }
    if (missing.empty() || std::chrono::steady_clock::now() > deadline) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return missing;
}

}  // namespace vismem
