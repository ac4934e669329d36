#include "pantilt_server/app/component.h"

#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>

#include "common/drivers/driver_registry.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "common/process/stream_health.h"
#include "common/robot_ice/pantilt_ice.h"
#include "drivers/pantilt_simulated/simulated_pan_tilt_unit.h"
#include "drivers/pantilt_uvc/uvc_pan_tilt.h"
#include "drivers/ptu46/ptu46_unit.h"
#ifdef VISMEM_HAS_MAESTRO
#include "drivers/pololu_maestro/maestro_pan_tilt.h"
#endif

namespace vismem {
namespace {

void registerPanTiltDrivers(DriverRegistry<PanTiltUnit>& registry) {
  registry.add("simulated", "two joints that exist in this process only", makeSimulatedPanTiltUnit);
  registry.add("ptu46", "a Directed Perception PTU-46 or D46 on a serial port", makePtu46Unit);
  registry.add("uvc", "a camera that turns by itself, by USB", makeUvcPanTilt);
#ifdef VISMEM_HAS_MAESTRO
  registry.add("maestro", "two servos on a Pololu Maestro by USB", makeMaestroPanTilt);
#endif
}

class PanTiltServer : public Component {
 public:
  PanTiltServer(std::unique_ptr<PanTiltUnit> unit, const Eigen::Vector3d& p_robot)
      : unit_(std::move(unit)), servant_(std::make_shared<PanTiltServant>(*unit_, p_robot)) {}

  void start(ComponentHost& host) override {
    const PortReply reply = unit_->start();
    if (!reply.ok()) throw std::runtime_error("the pan-tilt unit does not start: " + reply.message);
    if (!reply.message.empty()) host.log().warning(reply.message);
    host.serve("PanTilt", servant_);
    servant_->start([health = StreamHealth(host.status(), "samples", "pan-tilt unit")](
                        const SampleBatch<PanTiltSample>& batch) mutable {
      const auto now = std::chrono::steady_clock::now();
      batch.samples.empty() ? health.nothing(batch.message, now)
                            : health.came(batch.samples.size(), now, batch.message);
    });
  }

  void stop() override {
    // The unit first: there are no more commands, and it must stand while other parts end.
    unit_->stop();
    servant_->stop();
  }

 private:
  std::unique_ptr<PanTiltUnit> unit_;
  std::shared_ptr<PanTiltServant> servant_;
};

std::unique_ptr<Component> configure(ConfigReader& reader,
                                     const std::function<void(DriverRegistry<PanTiltUnit>&)>& more) {
  ConfigReader config = reader.group("PanTiltServer");
  config.describe(basic("Position_m", "crossing of the axes on the robot, for JdeRobot's clients"));
  const auto axes = config.reals("Position_m", {0.0, 0.0, 0.0}, -10.0, 10.0);
  DriverRegistry<PanTiltUnit> drivers;
  registerPanTiltDrivers(drivers);
  if (more) more(drivers);
  auto unit = drivers.make(config);
  if (!config.good() || !unit) return nullptr;
  return std::make_unique<PanTiltServer>(std::move(unit), Eigen::Vector3d(axes[0], axes[1], axes[2]));
}

}  // namespace

ComponentSpec panTiltServerSpec(std::function<void(DriverRegistry<PanTiltUnit>&)> more) {
  ComponentSpec spec;
  spec.name = "pantilt_server";
  spec.prefix = "PanTiltServer";
  spec.summary = "Serves a pan-tilt unit.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9977";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11003";
  spec.configure = [more = std::move(more)](ConfigReader& reader) { return configure(reader, more); };
  return spec;
}

}  // namespace vismem
