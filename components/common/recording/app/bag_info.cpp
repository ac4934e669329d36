/// @file bag_info FILE...: what a recording holds, which parts of a robot it can play, and what it needs for
/// the others. See C1.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/config/config_error.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/recording/bag_advice.h"
#include "common/tool/command_line_tool.h"

namespace {

using namespace vismem;

void describe(const RobotLog& log, nlohmann::json& summary) {
  const auto& stamps = log.frameStamps();
  const double seconds = toSeconds(stamps.back() - stamps.front());
  StampUs longest_us = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    longest_us = std::max(longest_us, stamps[i] - stamps[i - 1]);
  const auto intrinsics = log.intrinsics(0);
  summary["frames"] = stamps.size();
  summary["frames_without_pose"] = log.framesWithoutPose();
  summary["first_s"] = toSeconds(stamps.front());
  summary["last_s"] = toSeconds(stamps.back());
  summary["camera_hz"] = seconds > 0 ? static_cast<double>(stamps.size() - 1) / seconds : 0.0;
  summary["longest_gap_s"] = toSeconds(longest_us);
  summary["width"] = intrinsics.width;
  summary["height"] = intrinsics.height;
  summary["fx_px"] = intrinsics.fx;
  summary["fy_px"] = intrinsics.fy;
  summary["odometry_samples"] = log.odometry().size();
  summary["joint_samples"] = log.joints().size();
  summary["camera_pose"] = log.knowsCameraPose() ? "tf" : log.joints().empty() ? "fixed" : "joints";
}

void printContents(const BagFile& bag) {
  for (const auto& topic : bag.topics()) {
    std::printf("%6zu  %-40s %s\n", topic.messages, topic.type.c_str(), topic.name.c_str());
  }
  std::printf("%.1f MB, %.1f s, compression %s\n", static_cast<double>(bag.bytes()) / 1e6,
              toSeconds(bag.endUs() - bag.beginUs()), joined(bag.compressions(), ", ").c_str());
  for (const std::string& note : bag.notes()) std::printf("note: %s\n", note.c_str());
}

void printAdvice(const BagAdvice& advice, const std::vector<std::string>& files) {
  for (const BagRole& role : advice.roles) {
    std::printf("%-12s %s\n", role.name.c_str(), role.topic.empty() ? "-" : role.topic.c_str());
    if (!role.needed.empty()) std::printf("             needed: %s\n", role.needed.c_str());
    if (!role.note.empty()) std::printf("             found: %s\n", role.note.c_str());
    if (role.candidates.size() > 1) {
      std::printf("             one of: %s (key %s)\n", joined(role.candidates, ", ").c_str(),
                  role.key.c_str());
    }
  }
  if (!advice.truth.empty()) std::printf("%-12s %s\n", "truth", advice.truth.c_str());
  if (!advice.log) {
    std::printf("It cannot be replayed yet:\n%s\n", advice.problem.c_str());
    return;
  }
  if (files.size() == 1 && std::filesystem::exists(std::filesystem::path(files.front()) / "session.json")) {
    // The recorder left map and configurations beside the bags.
    std::printf("It can be replayed:\n  scripts/run --setup replay --session '%s'\n", files.front().c_str());
    std::printf("It can be evaluated:\n  evaluate --bag '%s' --map '%s/map.csv' --out DIR\n",
                files.front().c_str(), files.front().c_str());
    return;
  }
  const std::string file = joined(files, ",");
  const std::string topics = topicsText(advice.options);
  const std::string recording = "--bag '" + file + "'" + (topics.empty() ? "" : " --topics " + topics);
  std::printf("It can be replayed:\n  scripts/run --setup replay %s --map MAP.csv\n", recording.c_str());
  std::printf("It can be evaluated:\n  evaluate %s --map MAP.csv --out DIR\n", recording.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Shows what a recording (ROS 1 bags) holds, which parts of a robot it can play here, and for each "
      "missing part "
      "what is needed and the key that names it; the last line is JSON.");
  std::vector<std::string> files;
  std::string topics;
  double fov_deg = 0.0;
  RobotLogOptions options;
  app.add_option("FILE", files, "bags, or folders of them: together one recording")->required();
  app.add_option(
      "--topics", topics,
      "ROLE=/topic,...: image, camera_info, odometry, joints, truth; robot, camera, odom (frames); pan, "
      "tilt (joints); fov=DEGREES, fixed=yes");
  app.add_option("--fov", fov_deg, "horizontal field of view of a camera without calibration [deg]")
      ->check(CLI::Range(1.0, 179.0));
  app.add_flag("--fixed", options.fixed_camera, "the camera does not turn, and its place is configured");
  if (const auto code = parseTool(app, argc, argv)) return *code;
  if (const std::string wrong = applyTopics(topics, options); !wrong.empty()) {
    std::cerr << "--topics " << wrong << "\n";
    return kExitUsage;
  }
  if (fov_deg > 0.0) options.fov_rad = degToRad(fov_deg);
  try {
    BagFile bag(bagsOf(files));
    printContents(bag);
    std::vector<std::string> notes = bag.notes();
    const BagAdvice advice = adviseOn(std::move(bag), options);
    printAdvice(advice, files);
    nlohmann::json summary{{"file", files.front()},
                           {"playable", advice.log.has_value()},
                           {"arguments", replayArguments(advice.options)}};
    if (advice.log) {
      for (std::size_t i = notes.size(); i < advice.log->notes().size(); ++i)
        std::printf("note: %s\n", advice.log->notes()[i].c_str());
      notes = advice.log->notes();
      describe(*advice.log, summary);
    } else {
      summary["problem"] = advice.problem;
    }
    summary["notes"] = notes;
    std::fflush(stdout);
    std::cout << summary.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } catch (const ConfigError& error) {
    std::cerr << error.what() << "\n";
    return kExitUsage;
  } catch (const std::exception& error) {
    std::fflush(stdout);
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
