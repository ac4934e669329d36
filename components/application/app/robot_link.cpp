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
namespace {

/// Makes proxies to the objects of one component.
class Proxies {
 public:
  Proxies(Ice::Communicator& communicator, const Launcher& launcher, std::string component)
      : communicator_(communicator), launcher_(launcher), component_(std::move(component)) {}

  template <typename Prx>
  std::shared_ptr<Prx> to(const std::string& identity) const {
    return Ice::uncheckedCast<Prx>(communicator_.stringToProxy(launcher_.proxy(component_, identity)));
  }

 private:
  Ice::Communicator& communicator_;
  const Launcher& launcher_;
  std::string component_;
};

}  // namespace

RobotLink::RobotLink(const RunOptions& options, const Launcher& launcher)
    : log_("run_application", LogLevel::kWarning), communicator_(makeCommunicator(Properties{}, log_)) {
  const bool simulated = options.setup == Setup::kSimulation;
  const Proxies robot(*communicator_, launcher, simulated ? "simulator" : "replay_server");
  camera_ = std::make_unique<RemoteFrameSource>(robot.to<avm::CameraPrx>("cameraA"));
  base_ = std::make_unique<RemoteMobileBase>(simulated ? robot.to<avm::BasePrx>("Motors") : nullptr,
                                             robot.to<avm::OdometryPrx>("Encoders"));
  if (simulated) {
    simulation_ = std::make_unique<RemoteSimulation>(robot.to<avm::SimulationPrx>("Simulation"));
  } else {
    replay_ = std::make_unique<RemoteReplay>(robot.to<avm::ReplayPrx>("Replay"));
  }
  const Proxies memory(*communicator_, launcher, "active_visual_memory");
  memory_ = std::make_unique<VisualMemoryClient>(memory.to<avm::VisualMemoryPrx>("VisualMemory"));
  gaze_ = std::make_unique<RemoteGaze>(memory.to<avm::GazePrx>("Gaze"));
  const Proxies localization(*communicator_, launcher, "localization");
  localization_ = std::make_unique<RemoteLocalization>(localization.to<avm::LocalizationPrx>("Localization"));
  std::vector<std::string> names{"active_visual_memory", "localization"};
  if (options.record) names.emplace_back("recorder");
  for (const std::string& name : names) status_proxies_.push_back(launcher.proxy(name, name + "/component"));
}

RobotLink::~RobotLink() {
  // Ports first: their pending requests hold on to the communicator.
  camera_.reset();
  base_.reset();
  memory_.reset();
  gaze_.reset();
  localization_.reset();
  simulation_.reset();
  replay_.reset();
  communicator_->destroy();
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
