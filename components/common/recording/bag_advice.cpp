#include "common/recording/bag_advice.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

struct RoleName {
  const char* name;
  std::string RobotLogOptions::*option;
  const char* key;  ///< of replay_server; empty: it does not play this
};
constexpr RoleName kRoles[] = {{"image", &RobotLogOptions::image_topic, "Topics.Image"},
                               {"camera_info", &RobotLogOptions::camera_info_topic, "Topics.CameraInfo"},
                               {"odometry", &RobotLogOptions::odometry_topic, "Topics.Odometry"},
                               {"joints", &RobotLogOptions::joint_topic, "Topics.Joints"},
                               {"truth", &RobotLogOptions::truth_topic, ""},
                               {"robot", &RobotLogOptions::robot_frame, "Frames.Robot"},
                               {"camera", &RobotLogOptions::camera_frame, "Frames.Camera"},
                               {"odom", &RobotLogOptions::odom_frame, "Frames.Odom"},
                               {"pan", &RobotLogOptions::pan_joint, "Joints.Pan"},
                               {"tilt", &RobotLogOptions::tilt_joint, "Joints.Tilt"}};

/// Roles of --topics that name no topic but say what a bag lacks.
constexpr const char* kFieldOfView = "fov";
constexpr const char* kFixed = "fixed";
constexpr double kMinimumView_deg = 1.0;
constexpr double kMaximumView_deg = 179.0;

/// As people write it: "60".
std::string degrees(double angle_rad) {
  std::ostringstream text;
  text << radToDeg(angle_rad);
  return text.str();
}

std::string listed(const std::vector<std::string>& items) {
  return items.empty() ? "none" : joined(items, ", ");
}

/// Of topics with nearly as many messages, such as the cameras of one robot, the name decides.
constexpr double kNearlyAll = 0.9;

/// Topics of these types, the one with most messages first.
std::vector<std::string> topicsOf(const BagFile& bag, const std::set<std::string>& types) {
  std::vector<BagTopic> fitting;
  for (const BagTopic& topic : bag.topics()) {
    if (types.contains(topic.type) && topic.messages > 0) fitting.push_back(topic);
  }
  double most = 0.0;
  for (const BagTopic& topic : fitting) most = std::max(most, static_cast<double>(topic.messages));
  const auto rank = [most](const BagTopic& topic) {
    const auto messages = static_cast<double>(topic.messages);
    return messages < kNearlyAll * most ? messages : most;
  };
  std::sort(fitting.begin(), fitting.end(), [rank](const BagTopic& a, const BagTopic& b) {
    return rank(a) == rank(b) ? a.name < b.name : rank(a) > rank(b);
  });
  std::vector<std::string> names;
  for (const BagTopic& topic : fitting) names.push_back(topic.name);
  return names;
}

/// Names the topic that plays a role, where the bag has several and the user has said nothing.
void choose(BagAdvice& advice, BagRole role, std::string RobotLogOptions::*option) {
  std::string& named = advice.options.*option;
  const bool known =
      std::find(role.candidates.begin(), role.candidates.end(), named) != role.candidates.end();
  if (!named.empty() && !known) {
    role.needed = "the bag has no topic " + named + " of that type: name one of " + listed(role.candidates);
  } else if (!role.candidates.empty()) {
    role.topic = named.empty() ? role.candidates.front() : named;
    if (role.candidates.size() > 1 || !named.empty()) {
      advice.options.*option = role.topic;
      advice.arguments.push_back("--" + role.key + "=" + role.topic);
    }
    role.needed.clear();
  }
  advice.roles.push_back(std::move(role));
}

void chooseImages(BagAdvice& advice, const BagFile& bag) {
  auto images = topicsOf(bag, {kRawImageType, kCompressedImageType});
  // The compressed twin of a raw topic holds the same pictures.
  std::erase_if(images, [&](const std::string& name) {
    return name.ends_with("/compressed") &&
           std::find(images.begin(), images.end(), name.substr(0, name.size() - 11)) != images.end() &&
           advice.options.image_topic != name;
  });
  choose(advice,
         {"images", "", std::move(images), "ReplayServer.Topics.Image",
          "a topic of type sensor_msgs/Image or sensor_msgs/CompressedImage"},
         &RobotLogOptions::image_topic);
}

void chooseCalibration(BagAdvice& advice, const BagFile& bag) {
  BagRole role{"calibration", "", topicsOf(bag, {kCameraInfoType}), "ReplayServer.Topics.CameraInfo",
               "a topic of type sensor_msgs/CameraInfo, or the camera's horizontal field of view: --topics "
               "fov=DEGREES, key ReplayServer.Camera.FieldOfView_deg"};
  // The one beside the images is found by itself.
  std::string beside = advice.roles.front().topic;
  if (beside.ends_with("/compressed")) beside.resize(beside.size() - 11);
  beside = beside.substr(0, beside.rfind('/') + 1) + "camera_info";
  const auto found = std::find(role.candidates.begin(), role.candidates.end(), beside);
  if (advice.options.camera_info_topic.empty() && found != role.candidates.end()) {
    role.topic = beside;
    role.needed.clear();
    advice.roles.push_back(std::move(role));
    return;
  }
  if (role.candidates.empty() && advice.options.fov_rad > 0.0) {
    role.topic = "(field of view)";
    role.needed.clear();
    advice.roles.push_back(std::move(role));
    return;
  }
  choose(advice, std::move(role), &RobotLogOptions::camera_info_topic);
}

void chooseOdometryRole(BagAdvice& advice, BagFile& bag, const std::vector<std::string>& transforms) {
  const std::string& named = advice.options.odometry_topic;
  const auto found = odometryTopics(bag, advice.truth);
  if (found.empty() && !transforms.empty() && named.empty()) {
    advice.roles.push_back({"odometry", transforms.front(), transforms, "ReplayServer.Frames.Odom", "", ""});
    return;
  }
  BagRole role{"odometry",
               "",
               {},
               "ReplayServer.Topics.Odometry",
               "a topic of type nav_msgs/Odometry, or transforms from odom to the robot (key "
               "ReplayServer.Frames.Odom)",
               ""};
  for (const OdometryTopic& topic : found) role.candidates.push_back(topic.name);
  if (found.size() > 1) role.note = textOf(found);
  if (found.size() > 1 && named.empty()) {
    const std::string chosen = chooseOdometry(found, advice.options.odom_frame);
    if (chosen.empty()) {
      role.needed = "which of " + role.note + " is meant: name it with the key " + role.key +
                    " or with --topics odometry=/NAME";
      advice.roles.push_back(std::move(role));
      return;
    }
    advice.options.odometry_topic = chosen;
  }
  choose(advice, std::move(role), &RobotLogOptions::odometry_topic);
}

}  // namespace

BagAdvice adviseOn(BagFile bag, const RobotLogOptions& wanted) {
  BagAdvice advice;
  advice.options = wanted;
  chooseImages(advice, bag);
  chooseCalibration(advice, bag);
  try {
    advice.truth = truthTopic(bag, wanted.truth_topic);
  } catch (const RecordingError& error) {
    advice.problem = error.what();
  }
  const auto transforms = topicsOf(bag, {kTransformType, kOldTransformType});
  chooseOdometryRole(advice, bag, transforms);
  std::string pose_needed =
      "transforms that join the robot's frame and the images' (keys ReplayServer.Frames.Robot and .Camera), "
      "or joints "
      "called head_yaw and head_pitch or pan and tilt (keys ReplayServer.Joints.Pan and .Tilt), or "
      "--topics fixed=yes, key ReplayServer.Camera.Fixed=yes, for a camera that does not turn";
  auto joints = topicsOf(bag, {kJointStateType});
  BagRole pose{"camera pose", transforms.empty() ? "" : transforms.front(), transforms,
               "ReplayServer.Frames.Camera", transforms.empty() ? pose_needed : ""};
  if (joints.size() > 1 || !wanted.joint_topic.empty()) {
    choose(advice, {"joints", "", joints, "ReplayServer.Topics.Joints", ""}, &RobotLogOptions::joint_topic);
  } else if (!joints.empty()) {
    advice.roles.push_back({"joints", joints.front(), joints, "ReplayServer.Topics.Joints", ""});
  }
  if (transforms.empty() && !joints.empty()) {
    pose.topic = joints.front();
    pose.needed.clear();
  }
  if (wanted.fixed_camera) {
    pose.topic = "(fixed)";
    pose.needed.clear();
  }
  advice.roles.push_back(std::move(pose));
  for (const BagRole& role : advice.roles) {
    if (role.needed.empty()) continue;
    advice.problem += (advice.problem.empty() ? "" : "\n") + role.name + ": needed: " + role.needed;
  }
  if (!advice.problem.empty()) return advice;
  try {
    advice.log = RobotLog::open(std::move(bag), advice.options);
    // Transforms of other parts do not place the camera.
    if (!advice.log->knowsCameraPose() && !advice.log->joints().empty())
      advice.roles.back().topic = advice.log->topics().joints;
  } catch (const RecordingError& error) {
    advice.problem = error.what();
    if (advice.problem.find("camera's pose is unknown") != std::string::npos) {
      advice.roles.back().topic.clear();
      advice.roles.back().needed = pose_needed;
    }
  }
  return advice;
}

namespace {

/// @return whether the role is one of the camera; then it was applied, or `wrong` says why not.
bool applyCamera(const std::string& role, const std::string& value, RobotLogOptions& options,
                 std::string& wrong) {
  if (role == kFixed) {
    if (value != "yes") wrong = "(must be fixed=yes, for a camera that does not turn)";
    options.fixed_camera = value == "yes";
    return true;
  }
  if (role != kFieldOfView) return false;
  double view_deg = 0.0;
  const char* end = value.data() + value.size();
  const auto read = std::from_chars(value.data(), end, view_deg);
  const bool good = read.ec == std::errc() && read.ptr == end && view_deg >= kMinimumView_deg &&
                    view_deg <= kMaximumView_deg;
  if (!good) wrong = "(must be the camera's horizontal field of view, 1..179 degrees)";
  options.fov_rad = good ? degToRad(view_deg) : 0.0;
  return true;
}

}  // namespace

std::string applyTopics(const std::string& text, RobotLogOptions& options) {
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    const auto equals = item.find('=');
    const std::string role = item.substr(0, equals);
    std::string wrong;
    if (equals != std::string::npos && applyCamera(role, item.substr(equals + 1), options, wrong)) {
      if (!wrong.empty()) return "\"" + item + "\" " + wrong;
      continue;
    }
    const auto known = std::find_if(std::begin(kRoles), std::end(kRoles), [&](const RoleName& r) {
      return role == r.name || (role == "images" && r.option == &RobotLogOptions::image_topic);
    });
    if (equals == std::string::npos || equals + 1 == item.size() || known == std::end(kRoles)) {
      std::vector<std::string> names;
      for (const RoleName& r : kRoles) names.emplace_back(r.name);
      names.insert(names.end(), {kFieldOfView, kFixed});
      return "\"" + item + "\" (must be ROLE=/topic with a role of " + joined(names, ", ") + ")";
    }
    options.*(known->option) = item.substr(equals + 1);
  }
  return {};
}

std::vector<std::string> replayArguments(const RobotLogOptions& options) {
  std::vector<std::string> arguments;
  for (const RoleName& role : kRoles) {
    const std::string& value = options.*role.option;
    if (!value.empty() && *role.key != '\0')
      arguments.push_back("--ReplayServer." + std::string(role.key) + "=" + value);
  }
  if (options.fov_rad > 0.0)
    arguments.push_back("--ReplayServer.Camera.FieldOfView_deg=" + degrees(options.fov_rad));
  if (options.fixed_camera) arguments.emplace_back("--ReplayServer.Camera.Fixed=yes");
  return arguments;
}

std::string topicsText(const RobotLogOptions& options) {
  std::string text;
  const auto add = [&text](const std::string& role, const std::string& value) {
    if (!value.empty()) text += (text.empty() ? "" : ",") + role + "=" + value;
  };
  for (const RoleName& role : kRoles) add(role.name, options.*role.option);
  add(kFieldOfView, options.fov_rad > 0.0 ? degrees(options.fov_rad) : "");
  add(kFixed, options.fixed_camera ? "yes" : "");
  return text;
}

}  // namespace vismem
