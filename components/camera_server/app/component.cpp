#include "camera_server/app/component.h"

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "camera_server/app/camera_drivers.h"
#include "camera_server/app/camera_health.h"
#include "camera_server/app/config.h"
#include "common/drivers/host_clock.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "common/robot_ice/camera_ice.h"

namespace vismem {
namespace {

class CameraServer : public Component {
 public:
  explicit CameraServer(std::vector<ServedCamera> cameras) {
    for (ServedCamera& camera : cameras) {
      auto frames = std::make_unique<FrameBroadcaster>(camera.jpeg_quality);
      streams_.push_back({std::move(camera), std::move(frames)});
    }
  }

  void start(ComponentHost& host) override {
    for (Stream& stream : streams_) {
      start(stream, host);
      host.serve(stream.served.identity,
                 std::make_shared<CameraServant>(*stream.frames, stream.served.identity));
    }
  }

  void stop() override {
    // The cameras first: that ends the waits of those who read them.
    for (Stream& stream : streams_) stream.served.camera->stop();
    for (Stream& stream : streams_) stream.frames->stop();
  }

 private:
  struct Stream {
    ServedCamera served;
    std::unique_ptr<FrameBroadcaster> frames;
  };

  void start(Stream& stream, ComponentHost& host) {
    PreparedCamera& camera = *stream.served.camera;
    const std::string& name = stream.served.identity;
    const PortReply configured = camera.configure(stream.served.request);
    if (!configured.ok()) {
      // Other cameras of this process are served; this one reports its problem.
      stream.frames->setState(SourceState::kWaiting, configured.message);
      host.status().fault(name, configured.message);
      return;
    }
    const FrameCapabilities capabilities = camera.capabilities();
    if (!configured.message.empty()) {
      host.log().warning(name + ": not as asked, but " + configured.message);
    }
    host.log().info(name + ": " + capabilities.name);
    if (const PortReply started = camera.start(); !started.ok()) {
      stream.frames->setState(SourceState::kWaiting, started.message);
      host.status().fault(name, started.message);
      return;
    }
    stream.frames->start(camera, [&camera, health = CameraHealth(host.status(), name, capabilities.rate_hz)](
                                     const FrameResult& result) mutable {
      health.heard(result, camera.lensProblem(), std::chrono::steady_clock::now(), hostClock_us());
    });
  }

  std::vector<Stream> streams_;
};

std::unique_ptr<Component> configure(ConfigReader& reader,
                                     const std::function<void(DriverRegistry<FrameSource>&)>& more) {
  DriverRegistry<FrameSource> drivers;
  registerCameraDrivers(drivers);
  if (more) more(drivers);
  ConfigReader config = reader.group("CameraServer");
  auto cameras = readCameraServerConfig(config, drivers);
  if (!config.good()) return nullptr;
  return std::make_unique<CameraServer>(std::move(cameras));
}

}  // namespace

ComponentSpec cameraServerSpec(std::function<void(DriverRegistry<FrameSource>&)> more) {
  ComponentSpec spec;
  spec.name = "camera_server";
  spec.prefix = "CameraServer";
  spec.summary = "Serves cameras.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9999";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11000";
  spec.configure = [more = std::move(more)](ConfigReader& reader) { return configure(reader, more); };
  return spec;
}

}  // namespace vismem
