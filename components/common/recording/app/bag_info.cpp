/// @file bag_info FILE: what a recording holds, and whether it can be replayed. DESIGN 11.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/geometry/angles.h"
#include "common/recording/robot_log.h"
#include "common/tool/command_line_tool.h"

namespace {

using vismem::RobotLog;

nlohmann::json describe(const RobotLog& log) {
  const auto& stamps = log.frameStamps();
  const double seconds = vismem::toSeconds(stamps.back() - stamps.front());
  vismem::StampUs longest_us = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    longest_us = std::max(longest_us, stamps[i] - stamps[i - 1]);
  const auto intrinsics = log.intrinsics(0);
  nlohmann::json summary;
  summary["file"] = log.file();
  summary["frames"] = stamps.size();
  summary["frames_without_pose"] = log.framesWithoutPose();
  summary["first_s"] = vismem::toSeconds(stamps.front());
  summary["last_s"] = vismem::toSeconds(stamps.back());
  summary["camera_hz"] = seconds > 0 ? static_cast<double>(stamps.size() - 1) / seconds : 0.0;
  summary["longest_gap_s"] = vismem::toSeconds(longest_us);
  summary["width"] = intrinsics.width;
  summary["height"] = intrinsics.height;
  summary["fx_px"] = intrinsics.fx;
  summary["fy_px"] = intrinsics.fy;
  summary["odometry_samples"] = log.odometry().size();
  summary["joint_samples"] = log.joints().size();
  summary["camera_pose"] = log.knowsCameraPose() ? "tf" : "joints";
  return summary;
}

void printTopics(const RobotLog& log) {
  const auto line = [](const char* what, const std::string& name) {
    std::printf("%-12s %s\n", what, name.empty() ? "-" : name.c_str());
  };
  const auto& topics = log.topics();
  line("images", topics.image);
  line("calibration", topics.camera_info);
  line("odometry", topics.odometry);
  line("joints",
       topics.joints.empty() ? "" : topics.joints + " (" + topics.pan_joint + ", " + topics.tilt_joint + ")");
  line("camera pose", topics.robot_frame.empty() ? "" : topics.robot_frame + " -> " + topics.camera_frame);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Shows what a recording (ROS 1 bag) holds; the last line is JSON.");
  std::string file;
  app.add_option("FILE", file, "the bag")->required();
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    vismem::BagFile bag(file);
    for (const auto& topic : bag.topics()) {
      std::printf("%6zu  %-32s %s\n", topic.messages, topic.type.c_str(), topic.name.c_str());
    }
    const RobotLog log = RobotLog::open(file);
    printTopics(log);
    std::fflush(stdout);
    std::cout << describe(log).dump() << "\n";
  } catch (const std::exception& error) {
    std::fflush(stdout);
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
