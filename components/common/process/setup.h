/// @file The folder of a setup, such as cfg/sim: which components it has and where they serve. No Ice.
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
  /// As the file has them; empty where it leaves them to the component.
  std::string endpoints;
};

/// The components of a setup, by name: every file NAME.cfg of the folder that sets a key of NAME's.
/// What else lies there (recordings.cfg) is no component's.
/// @throw ConfigError when the folder or one of its files cannot be read.
std::vector<SetupComponent> componentsOfSetup(const std::filesystem::path& folder);

/// What moves a component to other ports: `--KEY=VALUE` for every key of its file that holds endpoints or a
/// proxy, shifted. None for an offset of 0.
/// @throw ConfigError when the file cannot be read.
std::vector<std::string> portArguments(const std::filesystem::path& file, int offset);

}  // namespace vismem
