/// @file The run's view of its components: every part of the robot as a port, over Ice.
#pragma once

#include <Ice/Ice.h>
#include <avm/recorder.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "application/app/launcher.h"
#include "common/process/log.h"
#include "common/robot/control_ports.h"
#include "common/robot/ports.h"
#include "common/visual_memory/gaze.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Owns the clients and their communicator. Its ports are used by one thread each.
class RobotLink {
 public:
  /// @param launcher its components must be ready.
  RobotLink(const RunOptions& options, const Launcher& launcher);

  FrameSource& camera() { return *camera_; }
  MobileBase& base() { return *base_; }
  VisualMemorySource& memory() { return *memory_; }
  GazeClient& gaze() { return *gaze_; }
  LocalizationControl& localization() { return *localization_; }
  SimulationControl* simulation() { return simulation_.get(); }  ///< null on a recording
  ReplayControl* replay() { return replay_.get(); }              ///< null in a simulation

  /// @return why the recorder has ended the recording; empty while it records, and without one.
  std::string recordingFailure() const;

  /// Waits until memory and localization have found their peers, so that nothing of a recording is missed.
  /// @return the missing connections after the time; empty when all are connected.
  std::string waitForPeers(std::chrono::seconds timeout, const std::function<bool()>& interrupted);

 private:
  Logger log_;
  Ice::CommunicatorHolder communicator_;  ///< ends after the ports, whose pending requests hold on to it
  std::vector<std::string> status_proxies_;
  std::unique_ptr<FrameSource> camera_;
  std::unique_ptr<MobileBase> base_;
  std::unique_ptr<VisualMemorySource> memory_;
  std::unique_ptr<GazeClient> gaze_;
  std::unique_ptr<LocalizationControl> localization_;
  std::unique_ptr<SimulationControl> simulation_;
  std::unique_ptr<ReplayControl> replay_;
  std::shared_ptr<avm::RecorderPrx> recorder_;  ///< null: no recording
};

}  // namespace vismem
