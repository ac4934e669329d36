#include "fleet/app/component.h"

#include <avm/localization.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "common/process/status.h"
#include "common/process/status_client.h"
#include "fleet/app/config.h"
#include "fleet/app/robot_reports.h"
#include "fleet/app/topic.h"

namespace vismem {
namespace {

using SteadyClock = std::chrono::steady_clock;

/// A frozen component must not hold the report back for long.
constexpr std::chrono::milliseconds kStatusTimeout{500};
/// Above the bounded waits of one round: poses, states, publishing.
constexpr std::chrono::milliseconds kProgressLimit{15'000};

std::int64_t hostTime_us() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(since_1970).count();
}

class FleetAgent : public Component {
 public:
  explicit FleetAgent(FleetAgentConfig config) : config_(std::move(config)), reports_(config_.robot) {}

  void start(ComponentHost& host) override {
    if (config_.topics.empty()) return;
    topic_ = std::make_unique<RobotTopic>(host, config_.topics, config_.topic);
    if (!config_.localization.empty()) {
      localization_ = host.peer<avm::LocalizationPrx>("Localization", config_.localization);
    }
    thread_ = std::jthread(host.guarded([this, &host](const std::stop_token& stop) { run(stop, host); }));
  }

  void stop() override {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
  }

 private:
  void run(const std::stop_token& stop, ComponentHost& host) {
    std::mutex mutex;
    std::condition_variable_any pause;
    const auto period = std::chrono::duration_cast<SteadyClock::duration>(
        std::chrono::duration<double>(1.0 / config_.rate_hz));
    auto due = SteadyClock::now();
    while (!stop.stop_requested()) {
      host.status().alive("reports", kProgressLimit);
      const avm::RobotReport next = report(stop, host);
      if (stop.stop_requested()) return;
      if (topic_->publish(next)) host.status().count("reports");
      // Reports that were due meanwhile are left out.
      due = std::max(due + period, SteadyClock::now());
      std::unique_lock lock(mutex);
      pause.wait_until(lock, stop, due, [] { return false; });
    }
  }

  /// @return anything after a request to stop: each call may wait for seconds.
  avm::RobotReport report(const std::stop_token& stop, ComponentHost& host) {
    std::optional<avm::PoseEstimate> estimate;
    if (localization_) {
      try {
        estimate = localization_->call([](avm::LocalizationPrx& proxy) { return proxy.latest(); });
      } catch (const avm::NotAvailable&) {
        // No estimate yet.
      }
    }
    if (stop.stop_requested()) return {};
    return reports_.next(estimate, states(host), hostTime_us(), SteadyClock::now());
  }

  std::map<std::string, StatusAnswer> states(ComponentHost& host) const {
    std::vector<std::string> proxies;
    for (const auto& [name, proxy] : config_.parts) proxies.push_back(proxy);
    const auto answers = askStatus(*host.communicator(), proxies, kStatusTimeout);
    std::map<std::string, StatusAnswer> states;
    std::size_t i = 0;
    for (const auto& [name, proxy] : config_.parts) states[name] = answers[i++];
    return states;
  }

  const FleetAgentConfig config_;
  RobotReports reports_;
  std::unique_ptr<RobotTopic> topic_;
  std::shared_ptr<RemotePeer<avm::LocalizationPrx>> localization_;
  std::jthread thread_;
};

}  // namespace

ComponentSpec fleetAgentSpec() {
  ComponentSpec spec;
  spec.name = "fleet_agent";
  spec.prefix = "FleetAgent";
  spec.summary = "Registers the robot's gateway at its site and publishes the robot's pose and state there.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9978";
  spec.configure = [](ConfigReader& root) -> std::unique_ptr<Component> {
    auto config = readFleetAgentConfig(root);
    if (!root.good()) return nullptr;
    return std::make_unique<FleetAgent>(std::move(config));
  };
  return spec;
}

}  // namespace vismem
