#include "replay_server/app/replay_component.h"

#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "common/config/config_error.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/robot_ice/replay_ice.h"
#include "replay_server/app/config.h"
#include "replay_server/app/log_player.h"

namespace vismem {
namespace {

/// Reports to the player when a client asks for images, so that a log begins with its first consumer.
class ReplayCameraServant : public CameraServant {
 public:
  ReplayCameraServant(FrameBroadcaster& frames, LogPlayer& player)
      : CameraServant(frames, "cameraA"), player_(player) {}

  void getNextAsync(std::string format, Ice::Long last_sequence,
                    std::function<void(const avm::FrameResult&)> response,
                    std::function<void(std::exception_ptr)> exception, const Ice::Current& current) override {
    player_.consumerArrived();
    CameraServant::getNextAsync(std::move(format), last_sequence, std::move(response), std::move(exception),
                                current);
  }
  std::shared_ptr<jderobot::ImageData> getImageData(std::string format,
                                                    const Ice::Current& current) override {
    player_.consumerArrived();
    return CameraServant::getImageData(std::move(format), current);
  }

 private:
  LogPlayer& player_;
};

std::string describe(const RobotLog& log) {
  const auto& stamps = log.frameStamps();
  return log.file() + ": " + std::to_string(stamps.size()) + " images of " + log.topics().image + ", " +
         std::to_string(toSeconds(stamps.back() - stamps.front())) + " s, " +
         std::to_string(log.odometry().size()) + " odometry and " + std::to_string(log.joints().size()) +
         " joint samples, camera pose from " + (log.knowsCameraPose() ? "transforms" : "joints");
}

class ReplayComponent : public Component {
 public:
  ReplayComponent(RobotLog log, const LogPlayer::Params& params) : player_(std::move(log), params, clock_) {}

  void start(ComponentHost& host) override {
    host.log().info(describe(player_.log()));
    if (const auto left_out = player_.log().framesWithoutPose(); left_out > 0) {
      host.log().warning(std::to_string(left_out) +
                         " images are left out: no transform to the camera at their stamps");
    }
    for (const std::string& note : player_.log().notes()) host.log().warning(note);
    host.serve("cameraA", std::make_shared<ReplayCameraServant>(frames_, player_));
    host.serve("PanTilt", pan_tilt_);
    host.serve("Motors", std::make_shared<BaseServant>(player_.base()));
    host.serve("Encoders", odometry_);
    host.serve("Replay", std::make_shared<ReplayServant>(player_));
    // A JPEG of the log is passed on as it is.
    FrameRequest request;
    request.accept_native = true;
    player_.camera().configure(request);
    frames_.start(player_.camera(), [&status = host.status()](const FrameResult& result) {
      status.alive("reader of the recording");
      if (result.frame) status.count("cameraA");
    });
    pan_tilt_->start();
    odometry_->start();
  }

  void stop() override {
    player_.shutDown();
    frames_.stop();
    pan_tilt_->stop();
    odometry_->stop();
  }

 private:
  SteadyPacingClock clock_;
  LogPlayer player_;
  FrameBroadcaster frames_;
  std::shared_ptr<PanTiltServant> pan_tilt_ = std::make_shared<PanTiltServant>(player_.panTilt());
  std::shared_ptr<OdometryServant> odometry_ = std::make_shared<OdometryServant>(player_.base());
};

std::unique_ptr<Component> configure(ConfigReader& config) {
  ConfigReader reader = config.group("ReplayServer");
  const ReplayServerConfig settings = readReplayServerConfig(reader);
  if (!reader.good()) return nullptr;
  try {
    return std::make_unique<ReplayComponent>(RobotLog::open(settings.files, settings.log), settings.player);
  } catch (const RecordingError& error) {
    // A line for each thing that is missing.
    std::vector<std::string> problems;
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) problems.push_back(line);
    throw ConfigError(problems);
  }
}

}  // namespace

ComponentSpec replayServerSpec() {
  ComponentSpec spec;
  spec.name = "replay_server";
  spec.prefix = "ReplayServer";
  spec.summary = "Plays a recording of a robot over the robot's interfaces.";
  // Every object is served at every port; each of these is the port of a hardware server.
  for (const int port : {9999, 9990, 9997, 9977, 9973}) {
    spec.default_endpoints +=
        (spec.default_endpoints.empty() ? "" : ":") + ("tcp -h 127.0.0.1 -p " + std::to_string(port));
  }
  for (const int port : {11000, 11001, 11002, 11003, 11007}) {
    spec.default_web_endpoints +=
        (spec.default_web_endpoints.empty() ? "" : ":") + ("ws -h 127.0.0.1 -p " + std::to_string(port));
  }
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
