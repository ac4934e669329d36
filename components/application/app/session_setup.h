/// @file A recorded session in place of a setup's configuration. See C1, C2.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vismem {

/// What starts a component with the configuration that it had in a session:
/// `--Ice.Config=SESSION/cfg/NAME.cfg`, and its endpoints and proxies as the setup `replay` has them, shifted
/// by an offset.
/// @param replay_config cfg/replay/NAME.cfg. @throws ConfigError when one of the files cannot be read.
std::vector<std::string> sessionArguments(const std::filesystem::path& session, const std::string& component,
                                          const std::filesystem::path& replay_config, int port_offset);

/// A proxy's object where the setup `replay` serves it: "cameraA:tcp -h 10.0.0.1 -p 5" becomes
/// "cameraA:tcp -h 127.0.0.1 -p 9999". Empty for an object that a replay does not have (a simulation).
std::string proxyInReplay(const std::string& proxy, int port_offset);

}  // namespace vismem
