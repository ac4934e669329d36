// The smallest real component: calls the status of another one, if it has a peer. For component_test.
#include <avm/component.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "common/config/config_error.h"
#include "common/process/component.h"

namespace {

enum class Work { kServe, kFinish, kFailToStart, kFail, kFailSlowly, kThrow, kHang, kHangOnStop };

struct Settings {
  Work work = Work::kServe;
  std::string peer_proxy;
};

class Probe : public vismem::Component {
 public:
  explicit Probe(Settings settings) : settings_(std::move(settings)) {}

  void start(vismem::ComponentHost& host) override {
    if (settings_.work == Work::kFailToStart) throw std::runtime_error("the device does not open");
    if (!settings_.peer_proxy.empty()) peer_ = host.peer<avm::ComponentPrx>("Peer", settings_.peer_proxy);
    loop_ = std::jthread(host.guarded([this, &host](const std::stop_token& stop) { run(stop, host); }));
  }

  void stop() override {
    if (settings_.work == Work::kHangOnStop) std::this_thread::sleep_for(std::chrono::hours(1));
    if (settings_.work == Work::kFailSlowly) std::this_thread::sleep_for(std::chrono::seconds(1));
    if (!loop_.joinable()) return;
    loop_.request_stop();
    loop_.join();
  }

 private:
  void run(const std::stop_token& stop, vismem::ComponentHost& host) {
    try {
      if (settings_.work == Work::kFinish) host.requestStop();
      if (settings_.work == Work::kFail || settings_.work == Work::kFailSlowly)
        throw std::runtime_error("the loop has failed");
    } catch (...) {
      host.fail(std::current_exception());
    }
    if (settings_.work == Work::kThrow) throw std::runtime_error("the thread has thrown");
    host.status().alive("loop", std::chrono::milliseconds(300));
    std::mutex mutex;
    std::condition_variable_any pause;
    while (!stop.stop_requested()) {
      if (settings_.work != Work::kHang) host.status().alive("loop", std::chrono::milliseconds(5000));
      if (peer_ && peer_->call([](avm::ComponentPrx& proxy) { return proxy.getStatus(); })) {
        host.status().count("calls");
      }
      std::unique_lock lock(mutex);
      pause.wait_for(lock, stop, std::chrono::milliseconds(5), [] { return false; });
    }
  }

  const Settings settings_;
  std::shared_ptr<vismem::RemotePeer<avm::ComponentPrx>> peer_;
  std::jthread loop_;
};

std::unique_ptr<vismem::Component> configure(vismem::ConfigReader& root) {
  auto config = root.group("Probe");
  Settings settings;
  settings.work = config.choice("Work", Work::kServe,
                                {{"serve", Work::kServe},
                                 {"finish", Work::kFinish},
                                 {"fail_to_start", Work::kFailToStart},
                                 {"fail", Work::kFail},
                                 {"fail_slowly", Work::kFailSlowly},
                                 {"throw", Work::kThrow},
                                 {"hang", Work::kHang},
                                 {"hang_on_stop", Work::kHangOnStop}});
  settings.peer_proxy = config.text("Peer.Proxy", "");
  config.integer("Size", 8, 1, 64);
  if (config.boolean("BadMap", false)) throw vismem::ConfigError({"map.csv:7: label = 3 (must be a name)"});
  if (!root.good()) return nullptr;
  return std::make_unique<Probe>(settings);
}

}  // namespace

int main(int argc, char** argv) {
  vismem::ComponentSpec spec;
  spec.name = "probe_component";
  spec.prefix = "Probe";
  spec.summary = "Does next to nothing.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 0";
  spec.configure = configure;
  return vismem::runComponent(argc, argv, spec);
}
