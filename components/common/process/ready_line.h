/// @file The one line a component prints on stdout once it serves. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace vismem {

/// "localization ready: LocalizationAdapter=tcp -h 127.0.0.1 -p 9971:ws -h 127.0.0.1 -p 11005".
std::string readyLine(std::string_view component, std::string_view adapter, std::string_view endpoints);

/// @return the endpoints of a ready line, for proxies: "tcp -h 127.0.0.1 -p 9971:ws ..."; empty if it is
/// none.
std::optional<std::string> readyEndpoints(std::string_view line);

/// @param protocol  "tcp" or "ws".
/// @return the port of the first endpoint of the protocol in a ready line.
std::optional<int> readyPort(std::string_view line, std::string_view protocol = "tcp");

}  // namespace vismem
