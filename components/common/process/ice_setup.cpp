#include "common/process/ice_setup.h"

#include <chrono>
#include <mutex>
#include <utility>

#include "common/config/config_error.h"
#include "common/process/ice_failure.h"
#include "common/process/reply_limit.h"

namespace vismem {
namespace {

/// Lets a few messages pass in a while and counts the others: each failed call of a stranger is one.
/// Thread-safe.
class Throttle {
 public:
  /// @return whether this one passes; `left_out` is then how many did not since the last that did.
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

/// Answers that one client may leave unread [bytes]: a few of the largest images, three in flight.
constexpr std::int64_t kUnreadLimit_bytes = std::int64_t{64} << 20;

Origin originOf(const Properties& properties, const std::string& key) {
  const auto* entry = properties.find(key);
  return entry == nullptr ? Origin{properties.source(), 0} : entry->origin;
}

/// Ice leaves out endpoints of transports that it does not know. @param known  parts that it took, between
/// colons.
bool hasUnknownEndpoint(const std::string& text, std::size_t known) {
  bool quoted = false;
  std::size_t parts = 1;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (c == ':' && !quoted) ++parts;
  }
  return known > 1 && parts > known;
}

/// @return what is wrong with a proxy; empty if nothing is.
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

std::vector<Problem> checkEndpoints(const std::string& key, const std::string& endpoints,
                                    const Properties& properties, Ice::Communicator& communicator) {
  if (endpoints.empty()) return {};  // reported where it was read
  std::string wrong;
  try {
    const auto proxy = communicator.stringToProxy("x:" + endpoints);
    if (!hasUnknownEndpoint("x:" + endpoints, proxy->ice_getEndpoints().size() + 1)) return {};
    wrong = "one is of an unknown transport";
  } catch (const Ice::LocalException& failure) {
    wrong = describeFailure(failure);
  }
  const auto quoted = wrong.find(" in `x:");
  if (quoted != std::string::npos) wrong.erase(quoted);
  return {{originOf(properties, key),
           key + " = " + endpoints + " (must be endpoints such as tcp -h 127.0.0.1 -p 9999: " + wrong + ")"}};
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

std::string publishedEndpoints(Ice::ObjectAdapter& adapter) {
  std::string text;
  for (const auto& endpoint : adapter.getPublishedEndpoints()) {
    text += (text.empty() ? "" : ":") + withoutUsualOptions(endpoint->toString());
  }
  return text;
}

}  // namespace vismem
