/// @file The one line a component prints on stdout once it serves. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace vismem {

/// "localization ready: LocalizationAdapter=tcp -h 127.0.0.1 -p 9971", and with endpoints for WebSocket
/// " LocalizationWebAdapter=ws -h 127.0.0.1 -p 11005" after it.
/// @param web_endpoints empty: there are none, and `web_adapter` is not shown.
std::string readyLine(std::string_view component, std::string_view adapter, std::string_view endpoints,
                      std::string_view web_adapter = {}, std::string_view web_endpoints = {});

/// @return the endpoints of a ready line, for proxies: "tcp -h 127.0.0.1 -p 9971"; empty if it is none.
std::optional<std::string> readyEndpoints(std::string_view line);

}  // namespace vismem
