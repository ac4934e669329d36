/// @file Configuration of a component's process: its keys, their check as a whole, and their listings.
#pragma once

#include <Ice/Ice.h>

#include <memory>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "common/process/component.h"
#include "common/process/log.h"
#include "common/process/robot_identity.h"

namespace vismem {

/// Ice's name of the component's object adapter, under which its own keys stand.
std::string adapterName(const ComponentSpec& spec);
/// The name of the one that serves web pages.
std::string webAdapterName(const ComponentSpec& spec);

/// Endpoints of an adapter and the key that sets them.
struct EndpointsKey {
  std::string key;
  std::string value;
};

struct ProcessKeys {
  RobotKeys robot;
  EndpointsKey endpoints;
  EndpointsKey web_endpoints;
  /// Whether other machines may reach endpoints without TLS.
  bool plain_remote = false;
  LogLevel log_level = LogLevel::kInfo;
  bool end_with_parent = false;
};

/// The keys that every process has; problems stay with the reader.
ProcessKeys readProcessKeys(ConfigReader& root, const ComponentSpec& spec);

struct Configured {
  std::unique_ptr<Component> component;
  Ice::CommunicatorHolder communicator;
};

/// Reads the whole configuration and throws all its problems together.
/// @throws ConfigError
Configured configure(const ComponentSpec& spec, const Properties& properties, ConfigReader& config,
                     const ProcessKeys& keys, Logger& log);

/// Every key with its value, the defaults of Ice among them; without secrets.
std::vector<Setting> effectiveConfiguration(const ConfigReader& config, const Properties& properties);
/// For the log: one key a line with its origin.
std::string configurationText(const std::vector<Setting>& settings);

/// Prints the component's own keys, one a line: key, level, default, range, meaning, separated by tabs.
/// @param properties keys that bring others, such as the name of a driver.
void printKeys(const ComponentSpec& spec, const Properties& properties);
/// The same for people, with the keys that all components have.
void printHelp(const ComponentSpec& spec, const Properties& properties);

}  // namespace vismem
