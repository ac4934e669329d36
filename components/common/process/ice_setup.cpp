#include "common/process/ice_setup.h"

#include "common/config/config_error.h"
#include "common/process/ice_failure.h"

namespace vismem {
namespace {

/// Ice's messages in the component's own log.
class IceLogger : public Ice::Logger, public std::enable_shared_from_this<IceLogger> {
 public:
  explicit IceLogger(vismem::Logger& log) : log_(log) {}

  void print(const std::string& message) override { log_.info(message); }
  void trace(const std::string& category, const std::string& message) override {
    log_.info("Ice " + category + ": " + message);
  }
  void warning(const std::string& message) override { log_.warning("Ice: " + message); }
  void error(const std::string& message) override { log_.error("Ice: " + message); }
  std::string getPrefix() override { return ""; }
  std::shared_ptr<Ice::Logger> cloneWithPrefix(const std::string&) override { return shared_from_this(); }

 private:
  vismem::Logger& log_;
};

Origin originOf(const Properties& properties, const std::string& key) {
  const auto* entry = properties.find(key);
  return entry == nullptr ? Origin{properties.source(), 0} : entry->origin;
}

}  // namespace

const std::vector<Setting>& iceDefaults() {
  static const std::vector<Setting> defaults = {
      // An image of 1280x720 RGB is 2.8 MB; Ice's own limit is 1 MB [kB].
      {"Ice.MessageSizeMax", "16384", ""},
      // No call waits for ever, not even for a frozen peer or a half-open connection [ms].
      {"Ice.Default.InvocationTimeout", "3000", ""},
      {"Ice.Override.ConnectTimeout", "2000", ""},
      {"Ice.Override.CloseTimeout", "1000", ""},
      // A message that stops half-way, in or out, costs its connection: a client that sent half a request,
      // one that
      // is frozen and takes no more [ms]. Ours is also what every endpoint says of itself, see
      // withoutUsualOptions.
      {"Ice.Default.Timeout", "10000", ""},
      // A connection without any message for so long goes; the next call makes another [s].
      {"Ice.ACM.Timeout", "30", ""},
      // A peer that restarts is not noticed by idempotent calls [ms].
      {"Ice.RetryIntervals", "0 200 500", ""},
      // Nothing is reachable from other machines, unless an endpoint names a host.
      {"Ice.Default.Host", "127.0.0.1", ""},
      // Dispatches do not block (long-polls are AMD), but one slow client must not hold up the others.
      {"Ice.ThreadPool.Server.Size", "2", ""},
      {"Ice.ThreadPool.Server.SizeMax", "8", ""},
      {"Ice.ThreadPool.Client.Size", "1", ""},
      {"Ice.ThreadPool.Client.SizeMax", "4", ""},
  };
  return defaults;
}

std::shared_ptr<Ice::Communicator> makeCommunicator(const Properties& properties, Logger& log) {
  Ice::InitializationData data;
  data.properties = Ice::createProperties();
  for (const auto& setting : iceDefaults()) data.properties->setProperty(setting.key, setting.value);
  for (const auto& [key, entry] : properties.entries()) data.properties->setProperty(key, entry.value);
  const bool own_log = properties.find("Ice.LogFile") == nullptr &&
                       properties.find("Ice.UseSyslog") == nullptr &&
                       properties.find("Ice.UseSystemdJournal") == nullptr;
  if (own_log) data.logger = std::make_shared<IceLogger>(log);
  return Ice::initialize(data);
}

std::vector<Problem> checkProxies(const ConfigReader& config, const Properties& properties,
                                  Ice::Communicator& communicator) {
  std::vector<Problem> problems;
  for (const auto& setting : config.effective()) {
    if (!setting.key.ends_with("Proxy") || setting.value.empty()) continue;
    try {
      communicator.stringToProxy(setting.value);
    } catch (const Ice::LocalException& failure) {
      problems.push_back({originOf(properties, setting.key),
                          setting.key + " = " + setting.value +
                              " (must be a proxy such as cameraA:tcp -h 127.0.0.1 -p 9999: " +
                              describeFailure(failure) + ")"});
    }
  }
  return problems;
}

std::shared_ptr<Ice::ObjectAdapter> makeAdapter(Ice::Communicator& communicator, const std::string& adapter,
                                                const std::string& key, const std::string& endpoints,
                                                const Properties& properties) {
  const auto malformed = [&](const std::string& reason) {
    const Problem problem{
        originOf(properties, key),
        key + " = " + endpoints + " (must be endpoints such as tcp -h 127.0.0.1 -p 9999: " + reason + ")"};
    return ConfigError({problem.text()});
  };
  try {
    return communicator.createObjectAdapterWithEndpoints(adapter, endpoints);
  } catch (const Ice::EndpointParseException& failure) {
    throw malformed(describeFailure(failure));
  } catch (const Ice::ProxyParseException& failure) {
    throw malformed(describeFailure(failure));
  } catch (const Ice::LocalException& failure) {
    throw std::runtime_error("cannot serve at " + key + " = " + endpoints + " (adapter " + adapter +
                             "): " + describeFailure(failure));
  }
}

std::string publishedEndpoints(Ice::ObjectAdapter& adapter) {
  std::string text;
  for (const auto& endpoint : adapter.getPublishedEndpoints()) {
    text += (text.empty() ? "" : ":") + withoutUsualOptions(endpoint->toString());
  }
  return text;
}

}  // namespace vismem
