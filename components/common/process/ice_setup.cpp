#include "common/process/ice_setup.h"

#include <chrono>
#include <mutex>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_format.h"
#include "common/process/ice_failure.h"
#include "common/process/registration.h"
#include "common/process/reply_limit.h"

namespace vismem {
namespace {

/// Rate limit of log messages: passes a few per interval and counts the others, because each failed call of
/// an untrusted client logs one. Thread-safe.
class Throttle {
 public:
  /// @return whether this message passes; `left_out` is then the number of dropped ones since the last.
  bool pass(long& left_out) {
    const auto now = std::chrono::steady_clock::now();
    const std::scoped_lock lock(mutex_);
    if (now >= end_) {
      end_ = now + std::chrono::seconds(10);
      passed_ = 0;
    }
    if (passed_ == kMost) {
      ++left_out_;
      return false;
    }
    ++passed_;
    left_out = std::exchange(left_out_, 0);
    return true;
  }

 private:
  static constexpr int kMost = 20;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point end_;
  int passed_ = 0;
  long left_out_ = 0;
};

/// Ice's messages in the component's own log.
class IceLogger : public Ice::Logger, public std::enable_shared_from_this<IceLogger> {
 public:
  explicit IceLogger(vismem::Logger& log) : log_(log) {}

  void print(const std::string& message) override { log_.info(message); }
  void trace(const std::string& category, const std::string& message) override {
    log_.info("Ice " + category + ": " + message);
  }
  void warning(const std::string& message) override { write(LogLevel::kWarning, message); }
  void error(const std::string& message) override { write(LogLevel::kError, message); }
  std::string getPrefix() override { return ""; }
  std::shared_ptr<Ice::Logger> cloneWithPrefix(const std::string&) override { return shared_from_this(); }

 private:
  void write(LogLevel level, const std::string& message) {
    long left_out = 0;
    if (!throttle_.pass(left_out)) return;
    if (left_out > 0) log_.warning("Ice: " + std::to_string(left_out) + " messages were left out");
    level == LogLevel::kError ? log_.error("Ice: " + message) : log_.warning("Ice: " + message);
  }

  vismem::Logger& log_;
  Throttle throttle_;
};

/// Maximum of unread answers of one client [bytes]: a few of the largest images, three in flight.
constexpr std::int64_t kUnreadLimit_bytes = std::int64_t{64} << 20;

Origin originOf(const Properties& properties, const std::string& key) {
  const auto* entry = properties.find(key);
  return entry == nullptr ? Origin{properties.source(), 0} : entry->origin;
}

/// Ice drops endpoints of unknown transports.
/// @param known the accepted parts, between colons.
bool hasUnknownEndpoint(const std::string& text, std::size_t known) {
  bool quoted = false;
  std::size_t parts = 1;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (c == ':' && !quoted) ++parts;
  }
  return known > 1 && parts > known;
}

/// @return the problem of a proxy; empty if it is valid.
std::string wrongProxy(const std::string& text, Ice::Communicator& communicator) {
  std::shared_ptr<Ice::ObjectPrx> proxy;
  try {
    proxy = communicator.stringToProxy(text);
  } catch (const Ice::LocalException& failure) {
    return describeFailure(failure);
  }
  if (proxy == nullptr) return "it is empty";
  const auto endpoints = proxy->ice_getEndpoints();
  if (hasUnknownEndpoint(text, endpoints.size() + 1)) return "it has an endpoint of an unknown transport";
  if (endpoints.empty() && proxy->ice_getLocator() == nullptr) {
    return "it has no endpoint, and no Ice.Default.Locator would find one";
  }
  for (const auto& endpoint : endpoints) {
    const auto address = std::dynamic_pointer_cast<Ice::IPEndpointInfo>(endpoint->getInfo());
    if (address != nullptr && address->port == 0) return "it has no port (-p)";
  }
  return "";
}

/// @return what is wrong with endpoints of a transport that the key may not hold; empty if nothing is.
std::string wrongTransport(const Ice::EndpointSeq& endpoints, Transport transport) {
  for (const auto& endpoint : endpoints) {
    const auto type = endpoint->getInfo()->type();
    const bool is_web = type == Ice::WSEndpointType || type == Ice::WSSEndpointType;
    if (is_web && transport == Transport::kNotWeb)
      return "ws and wss belong into the key WebEndpoints, where clients need a token";
    if (!is_web && transport == Transport::kWebOnly) return "only ws and wss belong here";
  }
  return "";
}

/// The address of an endpoint of any transport over IP; null for others.
std::shared_ptr<Ice::IPEndpointInfo> addressOf(const Ice::EndpointPtr& endpoint) {
  std::shared_ptr<Ice::EndpointInfo> info = endpoint->getInfo();
  while (info != nullptr && std::dynamic_pointer_cast<Ice::IPEndpointInfo>(info) == nullptr)
    info = info->underlying;
  return std::dynamic_pointer_cast<Ice::IPEndpointInfo>(info);
}

/// Whether other machines reach an endpoint.
bool isRemote(const Ice::EndpointPtr& endpoint) {
  const auto address = addressOf(endpoint);
  return address != nullptr && !isLoopback(address->host);
}

}  // namespace

const std::vector<Setting>& iceDefaults() {
  static const std::vector<Setting> defaults = {
      // An image of 1280x720 RGB is 2.8 MB; Ice's own limit is 1 MB [kB].
      {"Ice.MessageSizeMax", "16384", ""},
      // Bounds every call, also to a frozen peer or over a half-open connection [ms].
      {"Ice.Default.InvocationTimeout", "3000", ""},
      {"Ice.Override.ConnectTimeout", "2000", ""},
      {"Ice.Override.CloseTimeout", "1000", ""},
      // Closes a connection whose message stops half-way, in either direction: half a request, or a frozen
      // client that does not read [ms]. Every endpoint also contains this value, see withoutUsualOptions.
      {"Ice.Default.Timeout", "10000", ""},
      // Idle time after which a connection is closed; the next call opens another [s].
      {"Ice.ACM.Timeout", "30", ""},
      // Retries hide the restart of a peer from idempotent calls [ms].
      {"Ice.RetryIntervals", "0 200 500", ""},
      // Not reachable from other machines, unless an endpoint names a host.
      {"Ice.Default.Host", "127.0.0.1", ""},
      // Dispatches do not block (long-polls are AMD), but one slow client must not delay the others.
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
  if (registersProcess(data.properties)) data.properties->setProperty("Ice.Admin.DelayCreation", "1");
  const bool own_log = properties.find("Ice.LogFile") == nullptr &&
                       properties.find("Ice.UseSyslog") == nullptr &&
                       properties.find("Ice.UseSystemdJournal") == nullptr;
  if (own_log) data.logger = std::make_shared<IceLogger>(log);
  data.observer = std::make_shared<ReplyLimit>(kUnreadLimit_bytes, [&log](const std::string& peer) {
    log.warning(peer + " does not take its answers: closed");
  });
  try {
    return Ice::initialize(data);
  } catch (const Ice::LocalException& failure) {
    throw ConfigError(
        {properties.source() + ": Ice cannot begin with its keys (" + describeFailure(failure) + ")"});
  }
}

std::vector<Problem> checkProxies(const ConfigReader& config, const Properties& properties,
                                  Ice::Communicator& communicator) {
  std::vector<Problem> problems;
  for (const auto& setting : config.effective()) {
    if (!setting.key.ends_with("Proxy") || setting.value.empty()) continue;
    const auto wrong = wrongProxy(setting.value, communicator);
    if (wrong.empty()) continue;
    problems.push_back({originOf(properties, setting.key),
                        setting.key + " = " + setting.value +
                            " (must be a proxy such as cameraA:tcp -h 127.0.0.1 -p 9999: " + wrong + ")"});
  }
  return problems;
}

std::vector<Problem> checkEndpoints(const std::string& key, const std::string& endpoints, Transport transport,
                                    const Properties& properties, Ice::Communicator& communicator) {
  if (endpoints.empty()) return {};  // reported where it was read, or none are wanted
  const char* example =
      transport == Transport::kWebOnly ? "ws -h 127.0.0.1 -p 11000" : "tcp -h 127.0.0.1 -p 9999";
  std::string wrong;
  try {
    const auto proxy = communicator.stringToProxy("x:" + endpoints);
    if (hasUnknownEndpoint("x:" + endpoints, proxy->ice_getEndpoints().size() + 1)) {
      wrong = "one is of an unknown transport";
    } else {
      wrong = wrongTransport(proxy->ice_getEndpoints(), transport);
      if (wrong.empty()) return {};
    }
  } catch (const Ice::LocalException& failure) {
    wrong = describeFailure(failure);
  }
  const auto quoted = wrong.find(" in `x:");
  if (quoted != std::string::npos) wrong.erase(quoted);
  return {{originOf(properties, key),
           key + " = " + endpoints + " (must be endpoints such as " + example + ": " + wrong + ")"}};
}

std::vector<Problem> checkRemoteEndpoints(const std::string& key, const std::string& endpoints,
                                          Transport transport, const std::string& permission,
                                          const Properties& properties, Ice::Communicator& communicator) {
  if (endpoints.empty()) return {};
  Ice::EndpointSeq all;
  try {
    all = communicator.stringToProxy("x:" + endpoints)->ice_getEndpoints();
  } catch (const Ice::LocalException&) {
    return {};  // checkEndpoints reports it
  }
  const char* secure = transport == Transport::kWebOnly ? "wss" : "ssl";
  bool needs_certificates = false;
  for (const auto& endpoint : all) {
    if (!isRemote(endpoint)) continue;
    if (!endpoint->getInfo()->secure()) {
      return {{originOf(properties, key),
               key + " = " + endpoints + " (must be " + secure + " -h " + addressOf(endpoint)->host +
                   " ... with the keys IceSSL.* of docs/deployment.md, since other machines reach it, or -h "
                   "127.0.0.1 behind a gateway; " +
                   permission + " = yes lets everybody in)"}};
    }
    needs_certificates = transport == Transport::kNotWeb;
  }
  const auto* verify = properties.find("IceSSL.VerifyPeer");
  if (!needs_certificates || verify == nullptr || verify->value == "2") return {};
  return {{verify->origin, "IceSSL.VerifyPeer = " + verify->value +
                               " (must be 2, since other machines reach " + key +
                               ": each caller needs a certificate then)"}};
}

std::shared_ptr<Ice::ObjectAdapter> makeAdapter(Ice::Communicator& communicator, const std::string& adapter,
                                                const std::string& key, const std::string& endpoints) {
  try {
    return communicator.createObjectAdapterWithEndpoints(adapter, endpoints);
  } catch (const Ice::LocalException& failure) {
    throw std::runtime_error("cannot serve at " + key + " = " + endpoints + " (adapter " + adapter +
                             "): " + describeFailure(failure));
  }
}

namespace {

std::string textOf(const Ice::EndpointSeq& endpoints) {
  return joined(endpoints, ":",
                [](const auto& endpoint) { return withoutUsualOptions(endpoint->toString()); });
}

}  // namespace

std::string publishedEndpoints(Ice::ObjectAdapter& adapter) {
  return textOf(adapter.getPublishedEndpoints());
}

bool isLoopback(const std::string& host) {
  return host.starts_with("127.") || host == "::1" || host == "localhost";
}

std::string openEndpoints(Ice::ObjectAdapter& adapter) {
  Ice::EndpointSeq open;
  for (const auto& endpoint : adapter.getEndpoints()) {
    if (isRemote(endpoint) && !endpoint->getInfo()->secure()) open.push_back(endpoint);
  }
  return textOf(open);
}

}  // namespace vismem
