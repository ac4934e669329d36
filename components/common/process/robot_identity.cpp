#include "common/process/robot_identity.h"

#include <algorithm>

namespace vismem {
namespace {

constexpr std::size_t kLongestName = 40;
constexpr std::size_t kShortestToken = 16;
constexpr std::size_t kLongestToken = 100;
constexpr std::string_view kStatusSuffix = "/component";

/// Characters that need no escape in an identity, and no dot: it separates the parts of a category.
bool isPlain(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' || c == '_';
  });
}

std::string readToken(ConfigReader& robot, const Key& key) {
  const std::string name(key.name);
  const std::string token = robot.describe(key).text(name, "");
  if (token.empty()) return token;
  if (token.size() >= kShortestToken && token.size() <= kLongestToken && isPlain(token)) return token;
  robot.problem(name, "must be " + std::to_string(kShortestToken) + ".." + std::to_string(kLongestToken) +
                          " letters, digits, '-' or '_'");
  return "";
}

}  // namespace

RobotKeys readRobotKeys(ConfigReader& root) {
  ConfigReader robot = root.group("Robot");
  RobotKeys keys;
  robot.describe(expert("Name", "before each identity, as in NAME/Localization; empty: none"));
  keys.name = robot.text("Name", "");
  if (keys.name.size() > kLongestName || !isPlain(keys.name)) {
    robot.problem("Name", "must be 1.." + std::to_string(kLongestName) + " letters, digits, '-' or '_'");
    keys.name.clear();
  }
  keys.token = readToken(robot, expert("Token", "secret of operators, in the identities of web endpoints"));
  keys.view_token = readToken(robot, expert("ViewToken", "secret of readers, whose objects change nothing"));
  if (!keys.view_token.empty() && keys.view_token == keys.token)
    robot.problem("ViewToken", "must differ from Robot.Token");
  return keys;
}

std::string ownIdentity(const RobotKeys& robot, const std::string& identity) {
  if (robot.name.empty()) return identity;
  if (identity.ends_with(kStatusSuffix))
    return robot.name + ".component/" + identity.substr(0, identity.size() - kStatusSuffix.size());
  return robot.name + "/" + faceName(identity);
}

std::string faceName(const std::string& identity) {
  std::string name = identity;
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

std::string withoutRobot(const RobotKeys& robot, const std::string& identity) {
  const std::string own = robot.name + "/";
  const std::string status = robot.name + ".component/";
  if (robot.name.empty()) return identity;
  if (identity.starts_with(own)) return identity.substr(own.size());
  if (identity.starts_with(status)) return identity.substr(status.size()) + std::string(kStatusSuffix);
  return identity;
}

std::string componentOfStatus(const std::string& identity) {
  const auto slash = identity.find('/');
  const std::string category = identity.substr(0, slash);
  return category.ends_with(".component") ? identity.substr(slash + 1) : category;
}

bool isSecretKey(std::string_view key) {
  return key == "Robot.Token" || key == "Robot.ViewToken";
}

}  // namespace vismem
