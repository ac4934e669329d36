#include "common/process/setup.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <system_error>

#include "common/config/config_error.h"
#include "common/config/properties.h"

namespace vismem {

bool isKeyOf(const std::string& component, const std::string& key) {
  const auto plain = [](const std::string& text) {
    std::string result;
    for (const char c : text) {
      if (c != '_') result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return result;
  };
  const auto end = key.find('.');
  return end != std::string::npos && plain(key.substr(0, end)) == plain(component);
}

std::string shiftPorts(const std::string& text, int offset) {
  static const std::regex kPort("-p +([0-9]+)");
  std::string shifted;
  std::size_t done = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), kPort), end; match != end; ++match) {
    const int port = std::stoi((*match)[1]);
    const auto at = static_cast<std::size_t>(match->position(1));
    shifted += text.substr(done, at - done) + std::to_string(port == 0 ? 0 : port + offset);
    done = at + (*match)[1].length();
  }
  return shifted + text.substr(done);
}

bool isOptionalComponent(const std::string& name) {
  return name == "recorder" || name == "mapper";
}

bool mayBeLeftOut(const std::string& name) {
  return name == "gui_server";
}

std::vector<SetupComponent> componentsOfSetup(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::directory_iterator files(folder, error);
  if (error) throw ConfigError({folder.string() + ": " + error.message()});
  std::vector<SetupComponent> components;
  for (const auto& entry : files) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".cfg" || isOptionalComponent(name)) continue;
    const Properties properties = Properties::load(entry.path());
    properties.throwIfBad();
    bool is_component = false;
    SetupComponent component{name, entry.path(), {}, {}, {}};
    for (const auto& [key, value] : properties.entries()) {
      if (key == "Robot.Name") component.robot = value.value;
      if (!isKeyOf(name, key)) continue;
      is_component = true;
      const std::string rest = key.substr(key.find('.'));
      if (rest == ".Endpoints") component.endpoints = value.value;
      if (rest == ".WebEndpoints") component.web_endpoints = value.value;
    }
    if (is_component) components.push_back(std::move(component));
  }
  std::sort(components.begin(), components.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return components;
}

std::vector<std::string> portArguments(const std::filesystem::path& file, int offset) {
  const Properties properties = Properties::load(file);
  properties.throwIfBad();
  std::vector<std::string> arguments;
  if (offset == 0) return arguments;
  for (const auto& [key, entry] : properties.entries()) {
    if (!key.ends_with("Proxy") && !key.ends_with("Endpoints")) continue;
    arguments.push_back("--" + key + "=" + shiftPorts(entry.value, offset));
  }
  return arguments;
}

}  // namespace vismem
