/// @file Ports of a ready line, for tests that ask for free ones.
#pragma once

#include <optional>
#include <string>

namespace vismem {

/// @param protocol  "tcp" or "ws".
/// @return the port of the first endpoint of the protocol.
inline std::optional<int> readyPort(const std::string& line, const std::string& protocol = "tcp") {
  for (std::size_t at = line.find(protocol + " "); at != std::string::npos;
       at = line.find(protocol + " ", at + 1)) {
    if (line[at - 1] != '=' && line[at - 1] != ':') continue;
    const std::size_t port = line.find(" -p ", at);
    if (port != std::string::npos) return std::stoi(line.substr(port + 4));
  }
  return std::nullopt;
}

}  // namespace vismem
