#include "common/process/ready_line.h"

#include <algorithm>
#include <charconv>
#include <vector>

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

/// What stands after the `=` of each ADAPTER=ENDPOINTS of a ready line; endpoints hold no `=`.
std::vector<std::string_view> adaptersOf(std::string_view line) {
  std::vector<std::string_view> adapters;
  const auto ready = line.find(kReady);
  if (ready == std::string_view::npos) return adapters;
  std::string_view rest = line.substr(ready + kReady.size());
  for (auto equals = rest.find('='); equals != std::string_view::npos; equals = rest.find('=')) {
    rest.remove_prefix(equals + 1);
    const auto next = rest.find('=');
    adapters.push_back(next == std::string_view::npos ? rest : rest.substr(0, rest.rfind(' ', next)));
  }
  return adapters;
}

}  // namespace

std::string readyLine(std::string_view component, std::string_view adapter, std::string_view endpoints,
                      std::string_view web_adapter, std::string_view web_endpoints) {
  std::string line(component);
  line.append(kReady).append(adapter).append("=").append(endpoints);
  if (!web_endpoints.empty()) line.append(" ").append(web_adapter).append("=").append(web_endpoints);
  return line;
}

std::optional<std::string> readyEndpoints(std::string_view line) {
  const auto adapters = adaptersOf(line);
  return adapters.empty() ? std::nullopt : std::optional(std::string(adapters[0]));
}

std::optional<std::string> readyWebEndpoints(std::string_view line) {
  const auto adapters = adaptersOf(line);
  return adapters.size() < 2 ? std::nullopt : std::optional(std::string(adapters[1]));
}

std::optional<int> readyPort(std::string_view line, std::string_view protocol) {
  for (std::string_view rest : adaptersOf(line)) {
    while (!rest.empty()) {
      const auto end = std::min(rest.find(':'), rest.size());
      const auto endpoint = rest.substr(0, end);
      if (endpoint.starts_with(std::string(protocol) + " ")) return portOf(endpoint);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  return std::nullopt;
}

}  // namespace vismem
