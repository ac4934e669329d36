#include "common/process/process_configuration.h"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include "common/config/config_error.h"
#include "common/process/ice_setup.h"

namespace vismem {
namespace {

/// PREFIX.NAME, or ADAPTER.Endpoints, which is what an IceGrid node sets.
EndpointsKey readEndpoints(ConfigReader& root, const std::string& key, const std::string& adapter,
                           const std::string& fallback) {
  const std::string of_adapter = adapter + ".Endpoints";
  if (!root.isSet(of_adapter)) return {key, root.text(key, fallback)};
  root.known(key);
  if (root.isSet(key)) root.problem(of_adapter, "is the same as " + key + ", which is set too: keep one");
  return {of_adapter, root.text(of_adapter, fallback)};
}

/// A malformed token may be a real one with a typo: no message shows the value of a secret key.
void concealSecrets(std::vector<Problem>& problems, const Properties& properties) {
  for (const auto& [key, entry] : properties.entries()) {
    if (!isSecretKey(key) || entry.value.empty()) continue;
    for (Problem& problem : problems) {
      const auto at = problem.message.find(entry.value);
      if (at != std::string::npos) problem.message.replace(at, entry.value.size(), "***");
    }
  }
}

/// Declares every key to a reader, whatever is wrong.
void declareKeys(ConfigReader& config, const ComponentSpec& spec) {
  readProcessKeys(config, spec);
  try {
    spec.configure(config);
  } catch (const ConfigError&) {
    // A listing ignores missing required keys.
  }
}

}  // namespace

std::string adapterName(const ComponentSpec& spec) {
  return spec.prefix + "Adapter";
}

std::string webAdapterName(const ComponentSpec& spec) {
  return spec.prefix + "WebAdapter";
}

ProcessKeys readProcessKeys(ConfigReader& root, const ComponentSpec& spec) {
  auto config = root.group(spec.prefix);
  config.describe(basic("Endpoints", "where it serves"));
  config.describe(basic("WebEndpoints", "where it serves web pages; opens only with a token"));
  config.describe(basic("LogLevel", "messages below it are not logged"));
  config.describe(expert("PlainRemote", "other machines may reach endpoints without TLS"));
  config.describe(expert("EndWithParent", "ends when the process that started it ends"));
  ProcessKeys keys;
  keys.endpoints = readEndpoints(root, spec.prefix + ".Endpoints", adapterName(spec), spec.default_endpoints);
  if (keys.endpoints.value.empty())
    root.problem(keys.endpoints.key, "must be endpoints such as tcp -h 127.0.0.1 -p 9999");
  keys.web_endpoints =
      readEndpoints(root, spec.prefix + ".WebEndpoints", webAdapterName(spec), spec.default_web_endpoints);
  keys.plain_remote = config.boolean("PlainRemote", false);
  keys.robot = readRobotKeys(root);
  keys.log_level = config.choice("LogLevel", LogLevel::kInfo,
                                 {{"debug", LogLevel::kDebug},
                                  {"info", LogLevel::kInfo},
                                  {"warning", LogLevel::kWarning},
                                  {"error", LogLevel::kError}});
  keys.end_with_parent = config.boolean("EndWithParent", false);
  // Properties that Ice reads, and checks, itself: AdapterId, PublishedEndpoints, ThreadPool.Size ...
  root.known(adapterName(spec) + ".*");
  root.known(webAdapterName(spec) + ".*");
  return keys;
}

Configured configure(const ComponentSpec& spec, const Properties& properties, ConfigReader& config,
                     const ProcessKeys& keys, Logger& log) {
  // The keys of an unreadable file are unknown: no further problems.
  if (!properties.readable()) properties.throwIfBad();
  Configured configured;
  std::vector<std::string> more;
  const auto collect = [&more, &config](auto&& step) {
    try {
      step();
    } catch (const ConfigError& error) {
      const auto lines = config.withKeysOf(error.problems());
      more.insert(more.end(), lines.begin(), lines.end());
    }
  };
  collect([&] { configured.component = spec.configure(config); });
  auto problems = config.allProblems();
  const auto add = [&problems](const std::vector<Problem>& others) {
    problems.insert(problems.end(), others.begin(), others.end());
  };
  auto adapter_problems = checkAdapterKeys(properties, adapterName(spec));
  const auto web_problems = checkAdapterKeys(properties, webAdapterName(spec));
  adapter_problems.insert(adapter_problems.end(), web_problems.begin(), web_problems.end());
  add(adapter_problems);
  collect([&] {
    // With invalid keys of Ice, its defaults are sufficient to check proxies.
    const bool takes_keys = checkIceKeys(properties).empty() && adapter_problems.empty();
    configured.communicator =
        Ice::CommunicatorHolder(makeCommunicator(takes_keys ? properties : Properties{}, log));
    add(checkProxies(config, properties, *configured.communicator.communicator()));
    auto& communicator = *configured.communicator.communicator();
    const auto check = [&](const EndpointsKey& endpoints, Transport transport) {
      const auto wrong = checkEndpoints(endpoints.key, endpoints.value, transport, properties, communicator);
      add(wrong);
      if (wrong.empty() && !keys.plain_remote)
        add(checkRemoteEndpoints(endpoints.key, endpoints.value, transport, spec.prefix + ".PlainRemote",
                                 properties, communicator));
    };
    check(keys.endpoints, Transport::kNotWeb);
    check(keys.web_endpoints, Transport::kWebOnly);
  });
  concealSecrets(problems, properties);
  auto lines = problemLines(std::move(problems));
  lines.insert(lines.end(), more.begin(), more.end());
  if (!lines.empty()) throw ConfigError(lines);
  if (!configured.component) throw std::logic_error("configure() gave no component though nothing is wrong");
  return configured;
}

std::vector<Setting> effectiveConfiguration(const ConfigReader& config, const Properties& properties) {
  auto settings = config.effective();
  for (const auto& setting : iceDefaults()) {
    if (properties.find(setting.key) == nullptr) settings.push_back(setting);
  }
  for (const auto& [key, entry] : properties.entries()) {
    if (belongsToIce(key)) settings.push_back({key, entry.value, entry.origin.text()});
  }
  // Left out, so that a saved configuration can be read again.
  std::erase_if(settings,
                [](const Setting& setting) { return isSecretKey(setting.key) && !setting.value.empty(); });
  std::sort(settings.begin(), settings.end(),
            [](const Setting& a, const Setting& b) { return a.key < b.key; });
  return settings;
}

std::string configurationText(const std::vector<Setting>& settings) {
  std::string text = "configuration:";
  for (const auto& setting : settings) {
    text +=
        "\n" + setting.key + " = " + setting.value + (setting.origin.empty() ? "" : "   # " + setting.origin);
  }
  return text;
}

void printKeys(const ComponentSpec& spec, const Properties& properties) {
  ConfigReader config(properties);
  declareKeys(config, spec);
  for (const KeyDescription& one : config.keys()) {
    if (!one.key.starts_with(spec.prefix + ".")) continue;
    std::cout << one.key << "\t" << (one.is_basic ? "basic" : "expert") << "\t" << one.fallback << "\t"
              << one.range << "\t" << one.meaning << "\n";
  }
}

void printHelp(const ComponentSpec& spec, const Properties& properties) {
  ConfigReader config(properties);
  declareKeys(config, spec);
  std::cout << spec.name << ": " << spec.summary << "\n\n"
            << "usage: " << spec.name << " [--Ice.Config=FILE | FILE] [--Key=Value ...]\n"
            << "       " << spec.name << " [FILE] [--Key=Value ...] --help | --list-keys\n"
            << "       " << spec.name << " --version\n\n"
            << "Without a file the one named by the environment variable ICE_CONFIG is read.\n"
            << "Exit code: 0 after SIGINT or SIGTERM, 1 on a failure, 2 on a wrong configuration.\n\n"
            << "Keys and their defaults:\n";
  for (const KeyDescription& one : config.keys()) {
    std::cout << "  " << one.key << " = " << one.fallback;
    if (!one.range.empty() || !one.meaning.empty()) std::cout << "   # " << one.range;
    if (!one.meaning.empty()) std::cout << (one.range.empty() ? "" : "; ") << one.meaning;
    std::cout << "\n";
  }
}

}  // namespace vismem
