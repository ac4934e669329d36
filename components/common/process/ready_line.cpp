#include "common/process/ready_line.h"

#include <algorithm>
#include <charconv>

namespace vismem {
namespace {

constexpr std::string_view kReady = " ready: ";

std::optional<int> portOf(std::string_view endpoint) {
  constexpr std::string_view kOption = " -p ";
  const auto begin = endpoint.find(kOption);
  if (begin == std::string_view::npos) return std::nullopt;
  const auto digits = endpoint.substr(begin + kOption.size());
  int port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc() || end == digits.data()) return std::nullopt;
  return port;
}

}  // namespace

std::string readyLine(std::string_view component, std::string_view adapter, std::string_view endpoints) {
  return std::string(component) + std::string(kReady) + std::string(adapter) + "=" + std::string(endpoints);
}

std::optional<std::string> readyEndpoints(std::string_view line) {
  const auto ready = line.find(kReady);
  if (ready == std::string_view::npos) return std::nullopt;
  const auto equals = line.find('=', ready);
  if (equals == std::string_view::npos) return std::nullopt;
  return std::string(line.substr(equals + 1));
}

std::optional<int> readyPort(std::string_view line, std::string_view protocol) {
  const auto endpoints = readyEndpoints(line);
  if (!endpoints) return std::nullopt;
  std::string_view rest = *endpoints;
  while (!rest.empty()) {
    const auto end = std::min(rest.find(':'), rest.size());
    const auto endpoint = rest.substr(0, end);
    if (endpoint.starts_with(std::string(protocol) + " ")) return portOf(endpoint);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return std::nullopt;
}

}  // namespace vismem
