// The property names of Ice 3.7, so that a misspelt one is an error and not a warning that scrolls away.
#include <algorithm>
#include <array>
#include <vector>

#include "common/config/config_reader.h"
#include "common/config/nearest_name.h"

namespace vismem {
namespace {

constexpr std::array kServices = {"Ice",
                                  "IceSSL",
                                  "IceMX",
                                  "IceGrid",
                                  "IceGridAdmin",
                                  "IceStorm",
                                  "IceBox",
                                  "IceBoxAdmin",
                                  "IceBT",
                                  "IceDiscovery",
                                  "IceLocatorDiscovery",
                                  "IcePatch2",
                                  "IcePatch2Client",
                                  "Glacier2",
                                  "IceStormAdmin"};

/// Names below thread pools, connection management and proxies, which appear in several places.
constexpr std::array kThreadPool = {"Serialize", "Size",           "SizeMax",       "SizeWarn",
                                    "StackSize", "ThreadIdleTime", "ThreadPriority"};
constexpr std::array kConnections = {"Close", "Heartbeat", "Timeout"};
constexpr std::array kProxy = {"CollocationOptimized",
                               "ConnectionCached",
                               "EndpointSelection",
                               "InvocationTimeout",
                               "Locator",
                               "LocatorCacheTimeout",
                               "PreferSecure",
                               "Router"};
constexpr std::array kAdapter = {"AdapterId",    "Endpoints",          "Locator",        "MessageSizeMax",
                                 "ProxyOptions", "PublishedEndpoints", "ReplicaGroupId", "Router"};

constexpr std::array kPlain = {"AcceptClassCycles",
                               "Admin.DelayCreation",
                               "Admin.Enabled",
                               "Admin.Facets",
                               "Admin.InstanceName",
                               "Admin.Logger.KeepLogs",
                               "Admin.Logger.KeepTraces",
                               "Admin.Logger.Properties",
                               "Admin.ServerId",
                               "BackgroundLocatorCacheUpdates",
                               "BatchAutoFlush",
                               "BatchAutoFlushSize",
                               "CacheMessageBuffers",
                               "ChangeUser",
                               "ClassGraphDepthMax",
                               "ClientAccessPolicyProtocol",
                               "CollectObjects",
                               "Compression.Level",
                               "Config",
                               "ConsoleListener",
                               "Default.CollocationOptimized",
                               "Default.EncodingVersion",
                               "Default.EndpointSelection",
                               "Default.Host",
                               "Default.InvocationTimeout",
                               "Default.Locator",
                               "Default.LocatorCacheTimeout",
                               "Default.Package",
                               "Default.PreferSecure",
                               "Default.Protocol",
                               "Default.Router",
                               "Default.SlicedFormat",
                               "Default.SourceAddress",
                               "Default.Timeout",
                               "EventLog.Source",
                               "FactoryAssemblies",
                               "HTTPProxyHost",
                               "HTTPProxyPort",
                               "IPv4",
                               "IPv6",
                               "ImplicitContext",
                               "InitPlugins",
                               "LogFile",
                               "LogFile.SizeMax",
                               "LogStdErr.Convert",
                               "MessageSizeMax",
                               "Nohup",
                               "NullHandleAbort",
                               "Override.CloseTimeout",
                               "Override.Compress",
                               "Override.ConnectTimeout",
                               "Override.Secure",
                               "Override.Timeout",
                               "PluginLoadOrder",
                               "PreferIPv6Address",
                               "PreloadAssemblies",
                               "PrintAdapterReady",
                               "PrintProcessId",
                               "PrintStackTraces",
                               "ProgramName",
                               "RetryIntervals",
                               "SOCKSProxyHost",
                               "SOCKSProxyPort",
                               "ServerIdleTime",
                               "StdErr",
                               "StdOut",
                               "SyslogFacility",
                               "TCP.Backlog",
                               "TCP.RcvSize",
                               "TCP.SndSize",
                               "ThreadInterruptSafe",
                               "ThreadPriority",
                               "ToStringMode",
                               "Trace.Admin.Logger",
                               "Trace.Admin.Properties",
                               "Trace.Locator",
                               "Trace.Network",
                               "Trace.Protocol",
                               "Trace.Retry",
                               "Trace.Slicing",
                               "Trace.ThreadPool",
                               "UDP.RcvSize",
                               "UDP.SndSize",
                               "UseApplicationClassLoader",
                               "UseOSLog",
                               "UseSyslog",
                               "UseSystemdJournal",
                               "Warn.AMICallback",
                               "Warn.Connections",
                               "Warn.Datagrams",
                               "Warn.Dispatch",
                               "Warn.Endpoints",
                               "Warn.UnknownProperties",
                               "Warn.UnusedProperties"};

template <typename Names>
void addAll(std::set<std::string>& keys, const std::string& beginning, const Names& names) {
  for (const auto* name : names) keys.insert(beginning + name);
}

const std::set<std::string>& iceKeys() {
  static const std::set<std::string> keys = [] {
    std::set<std::string> all;
    addAll(all, "Ice.", kPlain);
    for (const char* pool : {"Ice.ThreadPool.Client.", "Ice.ThreadPool.Server.", "Ice.Admin.ThreadPool."}) {
      addAll(all, pool, kThreadPool);
    }
    for (const char* side : {"Ice.ACM.", "Ice.ACM.Client.", "Ice.ACM.Server.", "Ice.Admin.ACM."}) {
      addAll(all, side, kConnections);
    }
    for (const char* proxy :
         {"Ice.Default.Locator.", "Ice.Default.Router.", "Ice.Admin.Locator.", "Ice.Admin.Router."}) {
      addAll(all, proxy, kProxy);
    }
    addAll(all, "Ice.Admin.", kAdapter);
    return all;
  }();
  return keys;
}

std::string firstPart(std::string_view key) {
  return std::string(key.substr(0, key.find('.')));
}

}  // namespace

bool isIceProperty(std::string_view key) {
  if (key.starts_with("Ice.Plugin.") || key.starts_with("Ice.Package.") ||
      key.starts_with("Ice.InitPlugins.")) {
    return true;
  }
  return iceKeys().contains(std::string(key));
}

bool belongsToIce(std::string_view key) {
  return std::find(kServices.begin(), kServices.end(), firstPart(key)) != kServices.end();
}

std::vector<Problem> checkIceKeys(const Properties& properties) {
  std::vector<Problem> problems;
  for (const auto& [key, entry] : properties.entries()) {
    if (key.starts_with("Ice.") && !isIceProperty(key)) {
      problems.push_back({entry.origin, "unknown key \"" + key + "\"" + suggestion(key, iceKeys())});
    }
  }
  return problems;
}

std::vector<Problem> checkPrefixes(const Properties& properties, const std::set<std::string>& prefixes) {
  auto problems = checkIceKeys(properties);
  for (const auto& [key, entry] : properties.entries()) {
    if (belongsToIce(key) || prefixes.contains(firstPart(key))) continue;
    const auto nearest = nearestName(firstPart(key), prefixes);
    const auto rest = key.substr(firstPart(key).size());
    problems.push_back(
        {entry.origin, "unknown key \"" + key + "\"" +
                           (nearest.empty() ? "" : " (did you mean \"" + nearest + rest + "\"?)")});
  }
  return problems;
}

}  // namespace vismem
