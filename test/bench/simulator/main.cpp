// scripts/bench simulator: CPU time of a simulated image, stage by stage, and speed of the whole application
// in lock-step relative to real time. All figures are CPU time of the working thread.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/routes/route.h"
#include "common/tool/command_line_tool.h"
#include "evaluation/app/cpu_stages.h"
#include "evaluation/app/evaluation.h"
#include "simulator/core/image_errors.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"
#include "support/build_paths.h"

namespace {

using namespace vismem;
namespace fs = std::filesystem;

const fs::path kRoot = VISMEM_SOURCE_DIR;

struct Options {
  std::string world = "corridor";
  int views = 200;
  double seconds = 60.0;
  std::uint64_t seed = 1;
  std::string setup = "sim";
  fs::path out = "out/bench-simulator";
};

Route routeOf(const std::string& world) {
  const fs::path file = kRoot / "cfg/worlds" / (world + ".route");
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return parseRoute(text, file.string());
}

/// Places on the route, looked from as the gaze does: all around and down to the floor.
std::vector<Pose3> viewsOf(const Route& route, int count) {
  const SimulationConfig robot;
  std::mt19937_64 engine(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  std::vector<Pose3> views;
  for (int i = 0; i < count; ++i) {
    const RoutePlace place = placeAlong(route, uniform(0.0, route.length()));
    const Pose2 pose{place.position.x(), place.position.y(), place.heading_rad + uniform(-0.3, 0.3)};
    views.push_back(toPose3(pose) *
                    cameraPose(robot.mount(), uniform(-1.5, 1.5), uniform(degToRad(-31.0), degToRad(10.0))));
  }
  return views;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// CPU of single stages [ms], frame by frame.
class StageTable {
 public:
  template <typename Work>
  double measure(const Work& work) {
    CpuStages stages;
    stages.enter("work");
    work();
    return 1e3 * stages.seconds().at("work");
  }
  void add(const std::string& stage, double ms) { spent_[stage].push_back(ms); }
  double of(const std::string& stage) const { return median(spent_.at(stage)); }

 private:
  std::map<std::string, std::vector<double>> spent_;
};

nlohmann::json renderTable(const Options& options) {
  World world = loadWorld(kRoot / "cfg/worlds" / (options.world + ".world")).world;
  CpuStages stages;
  Renderer renderer(world, {{}, &stages});
  for (auto& light : world.lights) light.shadows = false;
  CpuStages unshadowed_stages;
  Renderer unshadowed(world, {{}, &unshadowed_stages});
  const SimulatedCameraParams camera;
  ImageErrors errors(camera.errors, 1);
  ImageErrorParams all_errors{2.0, 4.0, 0.1, 5.0};
  ImageErrors more_errors(all_errors, 1);

  StageTable table;
  const auto since = [](CpuStages& clock, const char* stage, double& before) {
    clock.enter("outside");
    const double now = 1e3 * clock.seconds()[stage];
    const double spent = now - before;
    before = now;
    return spent;
  };
  double first_before = 0.0, fine_before = 0.0, bare_before = 0.0;
  int n = 0;
  for (const Pose3& view : viewsOf(routeOf(options.world), options.views)) {
    cv::Mat image;
    const double whole = table.measure([&] { image = renderer.render(camera.intrinsics, view); });
    const double first = since(stages, "first rays", first_before);
    const double fine = since(stages, "antialiasing", fine_before);
    const double casting = table.measure([&] { renderer.renderTruth(camera.intrinsics, view); });
    table.measure([&] { unshadowed.render(camera.intrinsics, view); });
    const double bare = since(unshadowed_stages, "first rays", bare_before);
    const double noise = table.measure([&] { errors.apply(image, n, 1.0); });
    const double all_noise = table.measure([&] { more_errors.apply(image, n, 1.1); });
    if (n++ == 0) continue;  // it makes the tables of rays
    table.add("ray casting", casting);
    table.add("shading", std::max(0.0, bare - casting));
    table.add("shadows", std::max(0.0, first - bare));
    table.add("antialiasing", fine);
    table.add("read noise", noise);
    table.add("all errors", all_noise);
    table.add("whole frame", whole + noise);
  }

  nlohmann::json json;
  std::printf(
      "\nA frame of 320x240 in `%s`, shadows and adaptive antialiasing, one thread: CPU, medians of %d "
      "views\n\n",
      options.world.c_str(), options.views - 1);
  std::printf("| stage | ms |\n|---|---|\n");
  const std::vector<std::pair<const char*, const char*>> rows{
      {"ray casting", "ray casting (one ray a pixel; its truth images)"},
      {"shading", "shading"},
      {"shadows", "shadow rays"},
      {"antialiasing", "antialiasing (four rays where pixels differ)"},
      {"read noise", "read noise"},
      {"whole frame", "whole frame"},
      {"all errors", "(shot noise and exposure instead of read noise alone)"}};
  for (const auto& [stage, name] : rows) {
    std::printf("| %s | %.2f |\n", name, table.of(stage));
    json[stage] = table.of(stage);
  }
  return json;
}

nlohmann::json lockStepTable(const Options& options) {
  EvaluationOptions run;
  run.world = kRoot / "cfg/worlds" / (options.world + ".world");
  run.map = kRoot / "cfg/maps" / (options.world + ".csv");
  run.setup = options.setup;
  run.out = options.out / "run";
  run.seed = options.seed;
  run.seconds = options.seconds;
  run.profile = true;
  const nlohmann::json result = evaluate(run);
  std::printf(
      "\nThe whole application in lock-step, camera at 10 Hz, %.0f s of simulated time, seed %llu\n\n",
      options.seconds, static_cast<unsigned long long>(options.seed));
  std::printf("| stage | CPU ms a frame |\n|---|---|\n");
  for (const auto& [stage, ms] : result.at("cpu_ms_per_frame").items()) {
    if (stage != "all") std::printf("| %s | %.3f |\n", stage.c_str(), ms.get<double>());
  }
  std::printf("| all | %.3f |\n", result.at("cpu_ms_per_frame").at("all").get<double>());
  std::printf("\nReal-time factor: %.1f by the wall clock, %.1f by CPU time.\n",
              result.at("real_time_factor").get<double>(),
              result.at("real_time_factor_of_cpu").get<double>());
  return result;
}

void renderFrames(benchmark::State& state, const std::string& name) {
  const World world = loadWorld(kRoot / "cfg/worlds" / (name + ".world")).world;
  Renderer renderer(world);
  const SimulatedCameraParams camera;
  const auto views = viewsOf(routeOf(name), 32);
  renderer.render(camera.intrinsics, views.front());
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(renderer.render(camera.intrinsics, views[i++ % views.size()]).data);
  }
}

void step(benchmark::State& state) {
  SimulationConfig config;
  config.world = loadWorld(kRoot / "cfg/worlds/corridor.world").world;
  config.start = {-3.0, 2.25, 0.0};
  Simulation simulation(std::move(config));
  for (auto _ : state) simulation.step();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "CPU of simulated images by stage, and of the whole application in lock-step; the last line is JSON.",
      "bench simulator");
  Options options;
  app.add_option("--world", options.world, "of cfg/worlds, with a route and a map (default corridor)");
  app.add_option("--setup", options.setup, "robot of the lock-step run: sim or humanoid");
  app.add_option("--views", options.views, "images to measure")->check(CLI::Range(3, 100'000));
  app.add_option("--seconds", options.seconds, "of simulated time in lock-step")
      ->check(CLI::Range(1.0, 36'000.0));
  app.add_option("--seed", options.seed, "of the lock-step run");
  app.add_option("--out", options.out, "folder of the lock-step run's files");
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    benchmark::RegisterBenchmark("frame/corridor", renderFrames, "corridor")->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("frame/room", renderFrames, "room")->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("step of 10 ms without a frame", step)->Unit(benchmark::kMicrosecond);
    int no_arguments = 1;
    benchmark::Initialize(&no_arguments, argv);
    benchmark::RunSpecifiedBenchmarks();
    nlohmann::json json;
    json["frame_ms"] = renderTable(options);
    json["lock_step"] = lockStepTable(options);
    std::cout << std::endl << json.dump() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "bench simulator: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
