#include "base_server/app/component.h"

#include <chrono>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/drivers/driver_registry.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "common/process/stream_health.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/base_parameters.h"
#include "drivers/base_simulated/simulated_mobile_base.h"
#include "drivers/pioneer_p2os/pioneer_base.h"

namespace vismem {
namespace {

void registerBaseDrivers(DriverRegistry<MobileBase>& registry) {
  registry.add("simulated", "a differential drive that exists in this process only", makeSimulatedMobileBase);
  registry.add("pioneer", "a Pioneer robot (P2OS, ARCOS) on a serial port", makePioneerBase);
}

/// The objects of the base that this process serves.
struct Served {
  bool motors = true;
  bool encoders = true;
};

class BaseServer : public Component {
 public:
  BaseServer(std::unique_ptr<MobileBase> base, const Served& served)
      : base_(std::move(base)), served_(served), odometry_(std::make_shared<OdometryServant>(*base_)) {}

  void start(ComponentHost& host) override {
    host_ = &host;
    const PortReply reply = base_->start();
    if (!reply.ok()) throw std::runtime_error("the base does not start: " + reply.message);
    if (!reply.message.empty()) host.log().warning(reply.message);
    if (served_.motors) {
      const auto motors = std::make_shared<BaseServant>(*base_);
      host.serve("Motors", motors);
      listBaseParameters(host.parameters(), *base_, motors);
    }
    if (served_.encoders) host.serve("Encoders", odometry_);
    // Started even if odometry is not served: its samples show the health of the base.
    odometry_->start([health = StreamHealth(host.status(), "samples", "base")](
                         const SampleBatch<OdometrySample>& batch) mutable {
      const auto now = std::chrono::steady_clock::now();
      batch.samples.empty() ? health.nothing(batch.message, now)
                            : health.came(batch.samples.size(), now, batch.message);
    });
  }

  void stop() override {
    // The base first: there are no more commands, and it must stand before other parts end.
    base_->stop();
    if (host_ != nullptr) sayHowItStands();
    odometry_->stop();
  }

 private:
  void sayHowItStands() const {
    const auto batch = base_->samplesSince(kBeforeAllStamps, std::chrono::milliseconds(0));
    if (batch.samples.empty()) return;
    const OdometrySample& last = batch.samples.back();
    std::ostringstream text;
    if (last.v_mps == 0.0 && last.w_radps == 0.0) {
      text << "the base stands at x " << last.T_odom_robot.x << " m, y " << last.T_odom_robot.y
           << " m of odom";
      host_->log().info(text.str());
    } else {
      text << "the base received a stop command and still moved at the end: " << last.v_mps << " m/s, "
           << last.w_radps << " rad/s";
      host_->log().error(text.str());
    }
  }

  std::unique_ptr<MobileBase> base_;
  const Served served_;
  ComponentHost* host_ = nullptr;
  std::shared_ptr<OdometryServant> odometry_;
};

std::unique_ptr<Component> configure(ConfigReader& reader,
                                     const std::function<void(DriverRegistry<MobileBase>&)>& more) {
  ConfigReader config = reader.group("BaseServer");
  config.describe({basic("Serves", "the objects of this process")});
  enum class Serves { kBoth, kMotors, kEncoders };
  const Serves serves =
      config.choice("Serves", Serves::kBoth,
                    {{"both", Serves::kBoth}, {"motors", Serves::kMotors}, {"encoders", Serves::kEncoders}});
  DriverRegistry<MobileBase> drivers;
  registerBaseDrivers(drivers);
  if (more) more(drivers);
  auto base = drivers.make(config);
  if (!config.good() || !base) return nullptr;
  return std::make_unique<BaseServer>(std::move(base),
                                      Served{serves != Serves::kEncoders, serves != Serves::kMotors});
}

}  // namespace

ComponentSpec baseServerSpec(std::function<void(DriverRegistry<MobileBase>&)> more) {
  ComponentSpec spec;
  spec.name = "base_server";
  spec.prefix = "BaseServer";
  spec.summary = "Serves a mobile base: its motors, its encoders, or both.";
  // Both objects are served at every port; by convention each has one of its own.
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9990:tcp -h 127.0.0.1 -p 9997";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11001:ws -h 127.0.0.1 -p 11002";
  spec.configure = [more = std::move(more)](ConfigReader& reader) { return configure(reader, more); };
  return spec;
}

}  // namespace vismem
