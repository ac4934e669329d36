/// @file The names under which the objects of one robot are reached. Pure. docs/remote-access.md has the
/// scheme.
#pragma once

#include <string>
#include <string_view>

#include "common/config/config_reader.h"

namespace vismem {

/// The keys Robot.*, the same for all components of a robot.
struct RobotKeys {
  /// Robot.Name: letters, digits, '-' and '_'; empty: the robot has no name.
  std::string name;
  /// Robot.Token: whoever knows it may call every operation over WebSocket. Empty: nobody may.
  std::string token;
  /// Robot.ViewToken: whoever knows it may call the reading operations over WebSocket. Empty: nobody may only
  /// read.
  std::string view_token;

  /// Whether anything answers over WebSocket; if not, no such endpoint opens.
  bool servesWeb() const { return !token.empty() || !view_token.empty(); }

  /// What categories begin with: the name, or "robot" without one.
  std::string prefix() const { return name.empty() ? "robot" : name; }
  std::string viewCategory() const { return prefix() + ".view"; }
  /// Empty without a token.
  std::string tokenCategory() const { return token.empty() ? "" : prefix() + "." + token; }
  /// Empty without a token for viewers.
  std::string viewTokenCategory() const {
    return view_token.empty() ? "" : viewCategory() + "." + view_token;
  }
};

/// Reads and checks Robot.Name, Robot.Token and Robot.ViewToken.
RobotKeys readRobotKeys(ConfigReader& root);

/// The identity of an object for the robot's own components and JdeRobot's clients.
/// @param identity without a robot's name: "cameraA", or "localization/component" for a status.
/// @return the same without a name; else "robot7/cameraA" and "robot7.component/localization", and
/// "robot7/cameraA.depth" for "cameraA/depth", since a name has no '/'.
std::string ownIdentity(const RobotKeys& robot, const std::string& identity);

/// The name of an object in the categories of faces: "cameraA"; "localization.component" for a status,
/// "cameraA.depth" for "cameraA/depth".
std::string faceName(const std::string& identity);

/// The opposite of ownIdentity for the robot itself: "cameraA" for "robot7/cameraA", "localization/component"
/// for "robot7.component/localization". Any other identity stays.
std::string withoutRobot(const RobotKeys& robot, const std::string& identity);

/// The component whose status an identity is: "localization" for "localization/component" and for
/// "robot7.component/localization".
std::string componentOfStatus(const std::string& identity);

/// Whether a key's value is a secret, which no listing shows: Robot.Token, Robot.ViewToken.
bool isSecretKey(std::string_view key);

}  // namespace vismem
