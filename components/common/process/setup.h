/// @file The folder of a setup, such as cfg/sim: its components and their endpoints. No Ice. Implements C1.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vismem {

/// Whether a key is one of the component's: its first part is the component's name, but for case and '_':
/// "PanTiltServer.Endpoints" of "pantilt_server".
bool isKeyOf(const std::string& component, const std::string& key);

/// Adds an offset to every port ("-p N") of endpoints or proxies; an ephemeral port (0) stays.
std::string shiftPorts(const std::string& text, int offset);

struct SetupComponent {
  std::string name;
  std::filesystem::path file;
  /// Endpoints in the file; empty for the component's default.
  std::string endpoints;
  /// The same for WebSocket (NAME.WebEndpoints); they open only with a token.
  std::string web_endpoints;
  /// Robot.Name; empty without.
  std::string robot;
};

/// Whether a setup works without this component, which runs only on request: recorder and mapper.
bool isOptionalComponent(const std::string& name);

/// Whether a setup also runs whole without this component: the server of the page, which --no-gui leaves out.
bool mayBeLeftOut(const std::string& name);

/// The components of a setup, by name: every file NAME.cfg of the folder that sets a key of NAME's, without
/// the optional ones. Other files of the folder (recordings.cfg) are ignored.
/// @throw ConfigError when the folder or one of its files cannot be read.
std::vector<SetupComponent> componentsOfSetup(const std::filesystem::path& folder);

/// Arguments that shift the ports of a component: `--KEY=VALUE` for every key of its file with endpoints or a
/// proxy. None for an offset of 0.
/// @throw ConfigError when the file cannot be read.
std::vector<std::string> portArguments(const std::filesystem::path& file, int offset);

}  // namespace vismem
