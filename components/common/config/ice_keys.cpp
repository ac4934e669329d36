// The property names of Ice 3.7: a misspelt one is an error here, where Ice only prints a warning.
#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/config_reader.h"
#include "common/config/nearest_name.h"

namespace vismem {
namespace {

constexpr const char* kServices =
    "Ice IceSSL IceMX IceGrid IceGridAdmin IceStorm IceBox IceBoxAdmin IceBT IceDiscovery "
    "IceLocatorDiscovery IcePatch2 IcePatch2Client Glacier2 IceStormAdmin";

/// Names below thread pools, connection management and proxies, which appear in several places.
constexpr const char* kThreadPool = "Serialize Size SizeMax SizeWarn StackSize ThreadIdleTime ThreadPriority";
constexpr const char* kConnections = "Close Heartbeat Timeout";
constexpr const char* kProxy =
    "CollocationOptimized ConnectionCached EndpointSelection InvocationTimeout Locator "
    "LocatorCacheTimeout PreferSecure Router";
constexpr const char* kAdapter =
    "AdapterId Endpoints Locator MessageSizeMax ProxyOptions PublishedEndpoints ReplicaGroupId Router";

constexpr const char* kPlain =
    "AcceptClassCycles Admin.DelayCreation Admin.Enabled Admin.Facets Admin.InstanceName "
    "Admin.Logger.KeepLogs Admin.Logger.KeepTraces Admin.Logger.Properties Admin.ServerId "
    "BackgroundLocatorCacheUpdates BatchAutoFlush BatchAutoFlushSize CacheMessageBuffers ChangeUser "
    "ClassGraphDepthMax ClientAccessPolicyProtocol CollectObjects Compression.Level Config "
    "ConsoleListener Default.CollocationOptimized Default.EncodingVersion Default.EndpointSelection "
    "Default.Host Default.InvocationTimeout Default.Locator Default.LocatorCacheTimeout "
    "Default.Package Default.PreferSecure Default.Protocol Default.Router Default.SlicedFormat "
    "Default.SourceAddress Default.Timeout EventLog.Source FactoryAssemblies HTTPProxyHost "
    "HTTPProxyPort IPv4 IPv6 ImplicitContext InitPlugins LogFile LogFile.SizeMax LogStdErr.Convert "
    "MessageSizeMax Nohup NullHandleAbort Override.CloseTimeout Override.Compress "
    "Override.ConnectTimeout Override.Secure Override.Timeout PluginLoadOrder PreferIPv6Address "
    "PreloadAssemblies PrintAdapterReady PrintProcessId PrintStackTraces ProgramName RetryIntervals "
    "SOCKSProxyHost SOCKSProxyPort ServerIdleTime StdErr StdOut SyslogFacility TCP.Backlog "
    "TCP.RcvSize TCP.SndSize ThreadInterruptSafe ThreadPriority ToStringMode Trace.Admin.Logger "
    "Trace.Admin.Properties Trace.Locator Trace.Network Trace.Protocol Trace.Retry Trace.Slicing "
    "Trace.ThreadPool UDP.RcvSize UDP.SndSize UseApplicationClassLoader UseOSLog UseSyslog "
    "UseSystemdJournal Warn.AMICallback Warn.Connections Warn.Datagrams Warn.Dispatch Warn.Endpoints "
    "Warn.UnknownProperties Warn.UnusedProperties";

/// Adds names that blanks separate.
void addAll(std::set<std::string>& keys, const std::string& beginning, const char* names) {
  std::istringstream words(names);
  for (std::string name; words >> name;) keys.insert(beginning + name);
}
void addAdapterKeys(std::set<std::string>& keys, const std::string& adapter) {
  addAll(keys, adapter, kAdapter);
  addAll(keys, adapter + "ThreadPool.", kThreadPool);
  addAll(keys, adapter + "ACM.", kConnections);
  for (const char* proxy : {"Locator.", "Router."}) addAll(keys, adapter + proxy, kProxy);
}
std::set<std::string> setOf(const char* names) {
  std::set<std::string> result;
  addAll(result, "", names);
  return result;
}

const std::set<std::string>& iceKeys() {
  static const std::set<std::string> keys = [] {
    std::set<std::string> all;
    addAll(all, "Ice.", kPlain);
    for (const char* pool : {"Client.", "Server."})
      addAll(all, std::string("Ice.ThreadPool.") + pool, kThreadPool);
    for (const char* side : {"", "Client.", "Server."})
      addAll(all, std::string("Ice.ACM.") + side, kConnections);
    for (const char* proxy : {"Locator.", "Router."})
      addAll(all, std::string("Ice.Default.") + proxy, kProxy);
    addAdapterKeys(all, "Ice.Admin.");
    return all;
  }();
  return keys;
}

/// Integer properties that Ice replaces by a default with a warning, or accepts unchecked.
struct NumberRule {
  std::string endings;  ///< between blanks
  long minimum;
  long maximum;
};
constexpr long kLargest = 2'147'483'647;
const std::array kNumberRules = {
    // Not 0, which means no limit: a peer could then make this process take all memory.
    NumberRule{".MessageSizeMax", 1, 1'048'576},
    NumberRule{".Default.InvocationTimeout", -2, kLargest},
    NumberRule{".Default.Timeout .Override.CloseTimeout .Override.ConnectTimeout .Override.Timeout", -1,
               kLargest},
    NumberRule{".ThreadPool.Client.Size .ThreadPool.Client.SizeMax .ThreadPool.Server.Size "
               ".ThreadPool.Server.SizeMax .ThreadPool.Size .ThreadPool.SizeMax",
               1, 1000},
    NumberRule{".ACM.Timeout .ACM.Client.Timeout .ACM.Server.Timeout .TCP.RcvSize .TCP.SndSize", 0, kLargest},
    NumberRule{".ClassGraphDepthMax", 1, kLargest},
    NumberRule{".TCP.Backlog", 1, 65535},
    NumberRule{".Trace.Network", 0, 3},
    NumberRule{".Trace.Protocol .Warn.Connections", 0, 1},
    NumberRule{".Trace.Retry .Warn.Dispatch", 0, 2},
};

/// @return the problem of a value; empty if it is valid.
std::string wrongValue(const std::string& key, const std::string& value) {
  if (key == "Ice.Config") return "has no effect inside a configuration; must be on the command line";
  const auto rule = std::find_if(kNumberRules.begin(), kNumberRules.end(), [&](const NumberRule& r) {
    const auto endings = setOf(r.endings.c_str());
    return std::any_of(endings.begin(), endings.end(),
                       [&](const auto& ending) { return key.ends_with(ending); });
  });
  if (rule == kNumberRules.end()) return "";
  long number = 0;
  const auto* last = value.data() + value.size();
  const auto [end, error] = std::from_chars(value.data(), last, number);
  if (error == std::errc() && end == last && number >= rule->minimum && number <= rule->maximum) return "";
  return "must be a whole number, " + std::to_string(rule->minimum) + ".." + std::to_string(rule->maximum);
}

void checkValue(const std::string& key, const Properties::Entry& entry, std::vector<Problem>& problems) {
  const auto wrong = wrongValue(key, entry.value);
  if (wrong.empty()) return;
  problems.push_back(
      {entry.origin, key + " = " + (entry.value.empty() ? "(empty)" : entry.value) + " (" + wrong + ")"});
}

std::string firstPart(std::string_view key) {
  return std::string(key.substr(0, key.find('.')));
}

bool isIceProperty(std::string_view key) {
  return key.starts_with("Ice.Plugin.") || key.starts_with("Ice.Package.") ||
         key.starts_with("Ice.InitPlugins.") || iceKeys().contains(std::string(key));
}

}  // namespace

bool belongsToIce(std::string_view key) {
  static const std::set<std::string> kNames = setOf(kServices);
  return kNames.contains(firstPart(key));
}

std::vector<Problem> checkIceKeys(const Properties& properties) {
  std::vector<Problem> problems;
  for (const auto& [key, entry] : properties.entries()) {
    if (key.starts_with("Ice.") && !isIceProperty(key)) {
      problems.push_back({entry.origin, "unknown key \"" + key + "\"" + suggestion(key, iceKeys())});
    } else if (key.starts_with("Ice.")) {
      checkValue(key, entry, problems);
    }
  }
  return problems;
}

std::vector<Problem> checkAdapterKeys(const Properties& properties, const std::string& adapter) {
  std::set<std::string> keys;
  addAdapterKeys(keys, adapter + ".");
  std::vector<Problem> problems;
  for (const auto& [key, entry] : properties.entries()) {
    if (!key.starts_with(adapter + ".")) continue;
    if (keys.contains(key)) {
      checkValue(key, entry, problems);
    } else {
      problems.push_back({entry.origin, "unknown key \"" + key + "\"" + suggestion(key, keys)});
    }
  }
  return problems;
}

}  // namespace vismem
