/// @file map_from_drive: a map of labelled edges from a recording or a simulated drive.
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"
#include "mapper/app/live_map.h"
#include "mapper/app/map_making.h"

namespace {

struct Arguments {
  vismem::MapMakingOptions options;
  std::vector<double> start;
  std::vector<double> place;
  double seconds = 0.0;
  std::string perturb;
  std::string live;
  bool no_closing = false;
  bool no_right_angles = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  vismem::MapMakingOptions& options = arguments.options;
  vismem::EvaluationOptions& drive = options.drive;
  auto* bag = app.add_option("--bag", drive.bag,
                             "a recording: ROS 1 bag, several with commas between, or a folder of them");
  auto* world = app.add_option("--world", drive.world, "or a world to simulate: SDF, driven along its route");
  bag->excludes(world);
  app.add_option("--drive", options.saved_drive,
                 "or NAME.drive of an earlier map, to solve it again with edits")
      ->excludes(world)
      ->excludes(bag);
  app.add_option("--edits", options.edits, "changes by hand, replayed after each solve: docs/mapping.md");
  app.add_option("--live", arguments.live,
                 "or the drive that a running mapper records: its proxy, Mapper:tcp -h 127.0.0.1 -p 9974; it "
                 "writes into its own folder")
      ->excludes(world)
      ->excludes(bag)
      ->excludes("--drive");
  auto* since = app.add_option(
      "--since", options.files.since,
      "an earlier map of the place, made with the same palette: what was moved, removed and brought in "
      "(NAME.changes, for update_map)");
  app.add_option("--place", arguments.place,
                 "of this drive's map in the earlier one: x,y,theta [m, m, rad], within 1 m (default: found)")
      ->delimiter(',')
      ->expected(3)
      ->needs(since);
  app.add_option("--palette", drive.palette, "colours (default: the configuration's)");
  app.add_option("--out", drive.out, "folder for all that is written (but not with --live)");
  app.add_option("--name", options.files.name, "of the map's files")->capture_default_str();
  app.add_option(
      "--config", drive.config,
      "keys ActiveVisualMemory.* and Localization.* in one file (default: the components' files in "
      "cfg/SETUP)");
  app.add_option(
      "--setup", drive.setup,
      "configuration, and robot of a world: cfg/SETUP (default of a world sim, of a recording replay)");
  app.add_option("--seed", drive.seed, "of all that is random");
  app.add_option("--topics", drive.topics, "of a recording: ROLE=/topic,..., as bag_info advises")
      ->needs(bag);
  app.add_option("--route", drive.route, "way-points (default: beside the world, .route)")->needs(world);
  app.add_option("--scenario", drive.scenario, "what happens in a world: docs/scenarios.md")->needs(world);
  app.add_option("--laps", options.laps, "of a world's route, and 4 m more")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str()
      ->needs(world);
  app.add_option("--start", arguments.start, "of a world's robot: x,y,theta [m, m, rad] (default: drawn)")
      ->delimiter(',')
      ->expected(3)
      ->needs(world);
  app.add_option("--seconds", arguments.seconds,
                 "of the robot's time (default: a recording whole, a world by --laps)")
      ->check(CLI::PositiveNumber);
  app.add_option("--camera-rate", drive.camera_rate_hz, "of a simulated camera [Hz]")
      ->check(CLI::Range(0.5, 100.0))
      ->capture_default_str()
      ->needs(world);
  app.add_option("--perturb", arguments.perturb, "camera and odometry: as of evaluate")
      ->check([](const std::string& text) { return vismem::parsePerturbation(text).error; });
  app.add_option("--resolution", options.files.resolution_m, "of the occupancy grid [m]")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  app.add_flag("--no-closing", arguments.no_closing, "do not look for places seen before");
  app.add_flag("--no-right-angles", arguments.no_right_angles, "keep the angles as they were measured");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Makes a map from one drive: NAME.csv with NAME.palette, NAME.svg (make_map reads it back), NAME.dxf, "
      "NAME.pgm "
      "with NAME.yaml (map_server), NAME.json (covariance and times seen of each segment), NAME.history, "
      "NAME.png, "
      "trajectory.tum. "
      "The last line is JSON (docs/mapping.md).");
  Arguments arguments;
  declare(app, arguments);
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  vismem::MapMakingOptions& options = arguments.options;
  if (options.drive.bag.empty() && options.drive.world.empty() && options.saved_drive.empty() &&
      arguments.live.empty()) {
    std::cerr << "map_from_drive: expected one of --bag FILE, --world FILE, --drive FILE and --live PROXY\n";
    return vismem::kExitUsage;
  }
  if (options.drive.out.empty() && arguments.live.empty()) {
    std::cerr << "map_from_drive: --out is required\n";
    return vismem::kExitUsage;
  }
  if (!arguments.start.empty()) {
    options.drive.start = vismem::Pose2{arguments.start[0], arguments.start[1], arguments.start[2]};
  }
  if (!arguments.place.empty())
    options.files.place = vismem::Pose2{arguments.place[0], arguments.place[1], arguments.place[2]};
  if (!options.files.since.empty() && !options.saved_drive.empty() && !options.files.place) {
    std::cerr
        << "map_from_drive: --drive with --since needs --place: the record holds no images to find it\n";
    return vismem::kExitUsage;
  }
  if (arguments.seconds > 0.0) options.drive.seconds = arguments.seconds;
  options.drive.perturbation = vismem::parsePerturbation(arguments.perturb).perturbation;
  options.close = !arguments.no_closing;
  options.right_angles = !arguments.no_right_angles;
  try {
    const nlohmann::json summary =
        arguments.live.empty()
            ? vismem::makeMapFromDrive(options)
            : vismem::makeLiveMap(arguments.live, app.count("--name") > 0 ? options.files.name : "");
    for (const auto& note : summary.value("notes", nlohmann::json::array()))
      std::cerr << "map_from_drive: " << note.get<std::string>() << "\n";
    std::cout << summary.dump() << std::endl;
    if (!summary.contains("problems")) return 0;
    for (const auto& problem : summary["problems"]) {
      std::cerr << "map_from_drive: " << problem.get<std::string>() << "\n";
    }
    return 1;
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return vismem::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "map_from_drive: " << error.what() << "\n";
    return 1;
  }
}
