/// @file Where pages are served: "http -h HOST -p PORT", in the form of an Ice endpoint so that launchers
/// shift its port like all others. Pure.
#pragma once

#include <optional>
#include <string>

#include "common/process/robot_identity.h"

namespace vismem {

inline constexpr const char* kDefaultHttpEndpoint = "http -h 127.0.0.1 -p 8770";

struct HttpEndpoint {
  std::string host;
  /// 0: any free one.
  int port = 0;
};

/// @return empty unless the text is "http -h HOST -p PORT" with a port of 0..65535.
std::optional<HttpEndpoint> parseHttpEndpoint(const std::string& text);

/// What a person opens: "http://127.0.0.1:8770/"; of an endpoint for all addresses, that of this machine.
/// @param port the real one where the endpoint has 0.
std::string pageAddress(const HttpEndpoint& endpoint, int port);

/// The WebSocket endpoint of a proxy as the browser's policy names it: "ws://127.0.0.1:11000" for
/// "cameraA:ws -h 127.0.0.1 -p 11000". @return empty when the proxy has no endpoint of protocol ws or wss.
std::optional<std::string> webSocketSource(const std::string& proxy);

/// A proxy of a configuration as a web page uses it: with the category and the name of a face
/// (docs/remote-access.md). "robot.TOKEN/simulator.component:ws ..." for "simulator/component:ws ...".
/// @param proxy with or without the robot's name: "cameraA:ws ..." or "robot7/cameraA:ws ...".
std::string faceProxy(const std::string& proxy, const RobotKeys& robot, const std::string& category);

/// A proxy of a configuration under the object's own identity: "robot7/cameraA:tcp ..." for "cameraA:tcp
/// ...".
std::string ownProxy(const std::string& proxy, const RobotKeys& robot);

}  // namespace vismem
