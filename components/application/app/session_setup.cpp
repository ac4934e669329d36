#include "application/app/session_setup.h"

#include <map>

#include "common/config/properties.h"
#include "common/process/setup.h"

namespace vismem {

std::string proxyInReplay(const std::string& proxy, int port_offset) {
  static const std::map<std::string, int> kPorts{
      {"cameraA", 9999},      {"Motors", 9990}, {"Encoders", 9997},    {"PanTilt", 9977},
      {"VisualMemory", 9970}, {"Gaze", 9970},   {"Localization", 9971}};
  const std::string identity = proxy.substr(0, proxy.find_first_of(":@ "));
  const auto port = kPorts.find(identity);
  if (port == kPorts.end()) return {};
  return identity + ":tcp -h 127.0.0.1 -p " + std::to_string(port->second + port_offset);
}

std::vector<std::string> sessionArguments(const std::filesystem::path& session, const std::string& component,
                                          const std::filesystem::path& replay_config, int port_offset) {
  const std::filesystem::path file = session / "cfg" / (component + ".cfg");
  const Properties recorded = Properties::load(file);
  recorded.throwIfBad();
  std::vector<std::string> arguments{"--Ice.Config=" + file.string()};
  for (const auto& [key, entry] : recorded.entries()) {
    if (!isKeyOf(component, key) || !key.ends_with("Proxy") || entry.value.empty()) continue;
    arguments.push_back("--" + key + "=" + proxyInReplay(entry.value, port_offset));
  }
  const Properties replayed = Properties::load(replay_config);
  replayed.throwIfBad();
  for (const auto& [key, entry] : replayed.entries()) {
    if (!isKeyOf(component, key) || !key.ends_with("Endpoints")) continue;
    arguments.push_back("--" + key + "=" + shiftPorts(entry.value, port_offset));
  }
  return arguments;
}

}  // namespace vismem
