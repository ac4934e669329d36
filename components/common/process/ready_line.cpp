#include "common/process/ready_line.h"

namespace vismem {
namespace {

constexpr std::string_view kReady = " ready: ";

}  // namespace

std::string readyLine(std::string_view component, std::string_view adapter, std::string_view endpoints,
                      std::string_view web_adapter, std::string_view web_endpoints) {
  std::string line(component);
  line.append(kReady).append(adapter).append("=").append(endpoints);
  if (!web_endpoints.empty()) line.append(" ").append(web_adapter).append("=").append(web_endpoints);
  return line;
}

std::optional<std::string> readyEndpoints(std::string_view line) {
  const auto ready = line.find(kReady);
  const auto equals = line.find('=', ready);
  if (ready == std::string_view::npos || equals == std::string_view::npos) return std::nullopt;
  const auto rest = line.substr(equals + 1);
  // Of a second adapter; endpoints hold no '='.
  const auto next = rest.find('=');
  return std::string(next == std::string_view::npos ? rest : rest.substr(0, rest.rfind(' ', next)));
}

}  // namespace vismem
