#include "gui/server/http_endpoint.h"

#include <algorithm>
#include <regex>

namespace vismem {

std::optional<HttpEndpoint> parseHttpEndpoint(const std::string& text) {
  static const std::regex kForm(R"(\s*http\s+-h\s+([^\s:]+)\s+-p\s+([0-9]{1,5})\s*)");
  std::smatch match;
  if (!std::regex_match(text, match, kForm)) return std::nullopt;
  const int port = std::stoi(match[2]);
  if (port > 65535) return std::nullopt;
  return HttpEndpoint{match[1], port};
}

std::string pageAddress(const HttpEndpoint& endpoint, int port) {
  const bool any = endpoint.host == "0.0.0.0" || endpoint.host == "*";
  return "http://" + (any ? std::string("localhost") : endpoint.host) + ":" + std::to_string(port) + "/";
}

std::optional<std::string> webSocketSource(const std::string& proxy) {
  static const std::regex kEndpoint(R"(:\s*(wss?)\s+([^:]*))");
  static const std::regex kHost(R"(-h\s+([^\s]+))");
  static const std::regex kPort(R"(-p\s+([0-9]+))");
  std::smatch endpoint;
  if (!std::regex_search(proxy, endpoint, kEndpoint)) return std::nullopt;
  const std::string options = endpoint[2];
  std::smatch host;
  std::smatch port;
  if (!std::regex_search(options, host, kHost) || !std::regex_search(options, port, kPort))
    return std::nullopt;
  return endpoint[1].str() + "://" + host[1].str() + ":" + port[1].str();
}

std::string faceProxy(const std::string& proxy, const RobotKeys& robot, const std::string& category) {
  const auto end = std::min(proxy.find_first_of(": "), proxy.size());
  return category + "/" + faceName(withoutRobot(robot, proxy.substr(0, end))) + proxy.substr(end);
}

std::string ownProxy(const std::string& proxy, const RobotKeys& robot) {
  const auto end = std::min(proxy.find_first_of(": "), proxy.size());
  return ownIdentity(robot, withoutRobot(robot, proxy.substr(0, end))) + proxy.substr(end);
}

}  // namespace vismem
