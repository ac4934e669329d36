#include "gateway_access/app/component.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/process/log.h"
#include "common/process/status.h"
#include "gateway_access/ice/access_servants.h"

namespace vismem {
namespace {

struct AccessConfig {
  /// Password files by the name of the verifier: "operators", "viewers".
  std::vector<std::pair<std::string, std::filesystem::path>> files;
  int most_wrong = 5;
  /// Proxies of actuators with a lease, by name.
  std::vector<std::pair<std::string, std::string>> leased;
};

class GatewayAccess : public Component {
 public:
  explicit GatewayAccess(AccessConfig config) : config_(std::move(config)) {
    for (const auto& [role, file] : config_.files)
      passwords_.emplace_back(role, std::make_shared<Passwords>(file));
  }

  void start(ComponentHost& host) override {
    const auto guard = std::make_shared<LoginGuard>(config_.most_wrong);
    // Not in the faces, where a client of the gateway would reach them.
    for (const auto& [role, passwords] : passwords_) {
      host.adapter()->add(std::make_shared<LoginVerifier>(role, passwords, guard, host.log()), {role, ""});
    }
    std::vector<Sessions::Leased> leased;
    for (const auto& [name, proxy] : config_.leased) {
      leased.push_back(
          {name, Ice::uncheckedCast<avm::LeasablePrx>(host.communicator()->stringToProxy(proxy))});
    }
    const auto changed = [&status = host.status()](int count) {
      status.gauge({"sessions", static_cast<double>(count), 0.0, ""});
    };
    changed(0);
    host.adapter()->add(std::make_shared<Sessions>(std::move(leased), changed, host.log()), {"sessions", ""});
  }

  void stop() override {}

 private:
  const AccessConfig config_;
  std::vector<std::pair<std::string, std::shared_ptr<Passwords>>> passwords_;
};

std::unique_ptr<Component> configure(ConfigReader& reader) {
  ConfigReader config = reader.group("GatewayAccess");
  AccessConfig settings;
  config.describe({basic("Operators", "who may command"), basic("Viewers", "who may only read"),
                   expert("WrongLogins", "of an address in a minute; it is refused after them")});
  for (const auto& [key, role] : {std::pair{"Operators", "operators"}, std::pair{"Viewers", "viewers"}}) {
    settings.files.emplace_back(role, config.requireFile(key, "users and hashes of passwords"));
  }
  settings.most_wrong = static_cast<int>(config.integer("WrongLogins", 5, 1, 1000));
  for (const auto& name : config.children("Leased")) {
    const auto proxy = config.text("Leased." + name + ".Proxy", "");
    if (!proxy.empty()) settings.leased.emplace_back(name, proxy);
  }
  if (!config.good()) return nullptr;
  return std::make_unique<GatewayAccess>(std::move(settings));
}

}  // namespace

ComponentSpec gatewayAccessSpec() {
  ComponentSpec spec;
  spec.name = "gateway_access";
  spec.prefix = "GatewayAccess";
  spec.summary = "Answers the routers of a gateway: who may log in, and whose leases end with a session.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 4069";
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
