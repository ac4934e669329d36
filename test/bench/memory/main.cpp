// scripts/bench memory: CPU time of one iteration of the visual memory, from image to memory and gaze, stage
// by stage, and growth of time and memory over a simulated hour (M7). All times are CPU time of the working
// thread.
//
// The images of one lap are rendered first: the robot drives round in a circle while its camera looks about,
// and after a lap everything is where it was. The lap is then repeated with stamps that go on.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/geometry/angles.h"
#include "evaluation/app/cpu_stages.h"
#include "evaluation/app/evaluation_setup.h"
#include "over_time.h"
#include "simulator/core/image_errors.h"
#include "simulator/core/renderer.h"
#include "support/build_paths.h"

namespace {

using namespace vismem;
namespace fs = std::filesystem;

const fs::path kRoot = VISMEM_SOURCE_DIR;

struct Options {
  std::string world = "texture";
  std::string mode = "default";
  double rate_hz = 30.0;
  double lap_s = 30.0;
  double sweep_deg = 103.0;
  double minutes = 60.0;
  fs::path out = "out/bench-memory";
};

struct Lap {
  std::vector<RobotObservation> observations;
  double seconds = 0.0;
};

Lap render(const Options& options, const CameraMount& mount) {
  const World world = loadWorld(kRoot / "cfg/worlds" / (options.world + ".world")).world;
  Renderer renderer(world);
  const SimulatedCameraParams camera;
  ImageErrors errors(camera.errors, 1);
  Lap lap;
  const int images = static_cast<int>(std::lround(options.lap_s * options.rate_hz));
  lap.seconds = images / options.rate_hz;
  for (int i = 0; i < images; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / images;
    constexpr double kRadius_m = 0.5;
    RobotObservation o;
    o.T_odom_robot = {kRadius_m * std::cos(phase), kRadius_m * std::sin(phase),
                      wrapAngle(phase + 0.5 * std::numbers::pi)};
    // Five sweeps of the head a lap.
    o.pan_tilt = PanTilt{degToRad(options.sweep_deg) * std::sin(5.0 * phase),
                         degToRad(-20.0) + 0.1 * std::sin(3.0 * phase)};
    o.T_robot_camera = cameraPose(mount, o.pan_tilt->pan_rad, o.pan_tilt->tilt_rad);
    o.frame.intrinsics = camera.intrinsics;
    o.frame.image = renderer.render(camera.intrinsics, toPose3(o.T_odom_robot) * o.T_robot_camera);
    errors.apply(o.frame.image, static_cast<std::uint64_t>(i), 1.0);
    lap.observations.push_back(std::move(o));
  }
  return lap;
}

/// Resident memory of this process [MB].
double residentMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "CPU of one iteration of the visual memory by stage, and over a simulated hour; the last line is JSON.",
      "bench memory");
  Options options;
  app.add_option("--world", options.world, "of cfg/worlds, with a map and a palette")->capture_default_str();
  app.add_option("--mode", options.mode, "default or chapter")->capture_default_str();
  app.add_option("--rate", options.rate_hz, "images a second")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  app.add_option("--lap", options.lap_s, "seconds a lap")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  app.add_option("--sweep", options.sweep_deg,
                 "degrees that the head turns to either side: the less, the fewer elements are remembered")
      ->check(CLI::Range(0.0, 159.0))
      ->capture_default_str();
  app.add_option("--minutes", options.minutes, "of robot time")
      ->check(CLI::Range(0.5, 600.0))
      ->capture_default_str();
  app.add_option("--out", options.out, "folder of over_time.csv and over_time.png")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    EvaluationOptions evaluation;
    evaluation.world = kRoot / "cfg/worlds" / (options.world + ".world");
    evaluation.map = kRoot / "cfg/maps" / (options.world + ".csv");
    evaluation.mode = options.mode;
    const EvaluationParams params = loadParams(evaluation, true);
    const Lap lap = render(options, params.assembler.mount);
    MemoryPipeline pipeline(params.pipeline, params.palette);
    CpuStages stages;
    std::vector<double> iteration_ms;
    std::vector<Minute> minutes;
    double elements = 0.0;
    double all_ms = 0.0;
    double all_elements = 0.0;
    std::uint64_t frames = 0;
    const auto total = static_cast<std::uint64_t>(options.minutes * 60.0 * options.rate_hz);
    const auto per_minute =
        std::max<std::uint64_t>(1, std::llround(std::min(1.0, options.minutes) * 60.0 * options.rate_hz));
    for (; frames < total; ++frames) {
      RobotObservation o = lap.observations[frames % lap.observations.size()];
      o.frame.seq = frames;
      o.frame.stamp_us = toStampUs(static_cast<double>(frames + 1) / options.rate_hz);
      double before = 0.0;
      for (const auto& [stage, seconds] : stages.seconds()) before += stage == "outside" ? 0.0 : seconds;
      const auto result = pipeline.process(o, &stages);
      stages.enter("outside");
      double after = 0.0;
      for (const auto& [stage, seconds] : stages.seconds()) after += stage == "outside" ? 0.0 : seconds;
      iteration_ms.push_back(1e3 * (after - before));
      all_ms += iteration_ms.back();
      elements += static_cast<double>(result.update.snapshot->segments.size());
      if (iteration_ms.size() < per_minute) continue;
      std::vector<double> sorted = iteration_ms;
      std::sort(sorted.begin(), sorted.end());
      Minute minute;
      minute.minutes = static_cast<double>(frames + 1) / options.rate_hz / 60.0;
      for (const double ms : sorted) minute.mean_ms += ms / static_cast<double>(sorted.size());
      minute.p99_ms = sorted[sorted.size() * 99 / 100];
      minute.elements = elements / static_cast<double>(sorted.size());
      minute.resident_mb = residentMb();
      minutes.push_back(minute);
      all_elements += elements;
      elements = 0.0;
      iteration_ms.clear();
    }
    const auto n = static_cast<double>(frames);
    std::printf("`%s`, %s mode, 320x240 at %.0f Hz: CPU of one iteration, one thread\n\n",
                options.world.c_str(), options.mode.c_str(), options.rate_hz);
    std::printf("| stage | ms |\n|---|---|\n");
    nlohmann::json json{{"world", options.world}, {"mode", options.mode}, {"iterations", frames}};
    for (const auto& [stage, seconds] : stages.seconds()) {
      if (stage == "outside") continue;
      std::printf("| %s | %.3f |\n", stage.c_str(), 1e3 * seconds / n);
      json["stage_ms"][stage] = 1e3 * seconds / n;
    }
    std::printf("| all | %.3f |\n\n", all_ms / n);
    json["mean_ms"] = all_ms / n;
    json["share_of_a_core_at_30_hz"] = all_ms / n * 30.0 / 1e3;
    printTable(minutes);
    json.update(toJson(minutes));
    if (!options.out.empty()) {
      fs::create_directories(options.out);
      writeCsv(minutes, options.out / "over_time.csv");
      writeFigure(minutes, "The visual memory over time: `" + options.world + "`, " + options.mode + " mode",
                  options.out / "over_time.png");
      json["out"] = options.out.string();
    }
    std::cout << std::endl << json.dump() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "bench memory: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
