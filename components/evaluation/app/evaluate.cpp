/// @file evaluate: a recording, or a simulated drive, through memory and localization in lock-step.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"
#include "evaluation/app/evaluation.h"

namespace {

struct Arguments {
  std::vector<double> start;
  double seconds = 0.0;
  std::vector<std::uint64_t> judge;
  std::string perturb;
};

void declare(CLI::App& app, vismem::EvaluationOptions& options, Arguments& arguments) {
  auto* bag = app.add_option("--bag", options.bag,
                             "a recording: ROS 1 bag, several with commas between, or a folder of them");
  auto* world = app.add_option("--world", options.world, "or a world to simulate: SDF");
  bag->excludes(world);
  app.add_option("--map", options.map, "map of the world: CSV")->required();
  app.add_option("--out", options.out, "folder for all that is written")->required();
  app.add_option("--palette", options.palette, "colours (default: beside the map, else the configuration's)");
  app.add_option(
      "--config", options.config,
      "keys ActiveVisualMemory.* and Localization.* in one file, as cfg/replay/evaluate.cfg (default: the "
      "components' files in cfg/SETUP)");
  app.add_option("--mode", options.mode, "default or chapter, for both components (default: as configured)")
      ->check(CLI::IsMember({"default", "chapter"}));
  app.add_option("--seed", options.seed, "of all that is random");
  app.add_option("--start", arguments.start, "known start x,y,theta [m, m, rad]; without it, unknown")
      ->delimiter(',')
      ->expected(3);
  app.add_option("--seconds", arguments.seconds,
                 "of the robot's time (default: a recording whole, a world 60)")
      ->check(CLI::PositiveNumber);
  app.add_option("--truth", options.truth, "true poses of a recording: t_s,x_m,y_m,theta_rad")->needs(bag);
  auto* survey =
      app.add_option("--survey", options.survey.edges,
                     "true edges on the floor of a recording, CSV as a map: scores the last memory")
          ->needs(bag);
  app.add_option("--survey-neutral", options.survey.neutral, "edges that count neither as found nor as false")
      ->needs(survey);
  app.add_option("--survey-obstacles", options.survey.obstacles,
                 "boxes that hide floor: x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,name")
      ->needs(survey);
  app.add_option(
         "--topics", options.topics,
         "of a recording with several cameras or names of its own: ROLE=/topic,..., as bag_info advises")
      ->needs(bag);
  app.add_option("--judge", arguments.judge,
                 "images FIRST,LAST of a recording for map_projection_px (default: all)")
      ->delimiter(',')
      ->expected(2)
      ->needs(bag);
  app.add_option("--record", options.record,
                 "of a world: record the robot into this folder, for --bag FOLDER")
      ->needs(world);
  auto* second =
      app.add_option("--second-world", options.second_world,
                     "another world, in which the same robot gets the same commands, for --second-record");
  second->needs(app.add_option("--second-record", options.second_record,
                               "record the robot of the second world into this folder")
                    ->needs(second->needs(world)));
  app.add_option("--route", options.route, "way-points (default: beside the world, .route)")->needs(world);
  app.add_option(
      "--setup", options.setup,
      "configuration, and robot of a world: cfg/SETUP (default of a world sim, of a recording replay; "
      "humanoid, nao: walking robots)");
  app.add_option("--scenario", options.scenario, "what happens in a world: docs/scenarios.md")->needs(world);
  app.add_option("--perturb", arguments.perturb,
                 "camera and odometry: KEY=NUMBER,... of height [m], tilt [degrees], focal and brightness "
                 "(factors), white "
                 "(colour temperature [K]), gamma, vignette (share), noise [grey levels], scale (of the "
                 "image's size), jpeg "
                 "(quality), blur [px], late [s], every (one image of so many), way (factor of the "
                 "odometry's way), drift "
                 "(of its heading [degrees a minute])")
      ->check([](const std::string& text) { return vismem::parsePerturbation(text).error; });
  app.add_flag("--snapshots", options.snapshots,
               "the memory of each second in memory.csv and primitives.csv, not the last one alone");
  app.add_flag("--profile", options.profile, "add the real-time factor and CPU time by stage to the JSON");
  app.add_option("--camera-rate", options.camera_rate_hz, "of a simulated camera [Hz]")
      ->check(CLI::Range(0.5, 100.0))
      ->needs(world);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Runs a recording or a simulation through visual memory and localization, as fast as possible. Writes "
      "trajectory.tum, odometry.tum, races.csv, memory.csv, primitives.csv, top_view.png, last_image.png, "
      "and "
      "with a known truth truth.tum and error.png; the last line is JSON (docs/formats.md).");
  vismem::EvaluationOptions options;
  Arguments arguments;
  declare(app, options, arguments);
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  if (options.bag.empty() == options.world.empty()) {
    std::cerr << "evaluate: expected one of --bag FILE and --world FILE\n";
    return vismem::kExitUsage;
  }
  if (!arguments.start.empty()) {
    options.start = vismem::Pose2{arguments.start[0], arguments.start[1], arguments.start[2]};
  }
  if (!arguments.judge.empty()) {
    options.judge_first = arguments.judge[0];
    options.judge_last = arguments.judge[1];
  }
  options.perturbation = vismem::parsePerturbation(arguments.perturb).perturbation;
  if (arguments.seconds > 0.0) {
    options.seconds = arguments.seconds;
  } else if (!options.world.empty()) {
    options.seconds = 60.0;
  }
  try {
    const nlohmann::json summary = vismem::evaluate(options);
    std::cout << summary.dump() << std::endl;
    if (!summary.contains("problems")) return 0;
    for (const auto& problem : summary["problems"])
      std::cerr << "evaluate: " << problem.get<std::string>() << "\n";
    return 1;
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return vismem::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
