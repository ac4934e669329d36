// scripts/bench pipeline: CPU time from an image to the pose in one thread, stage by stage, beside tuned
// EDLines on the same images; and growth of time and memory over simulated minutes (M7). All times are CPU
// time. The stages are measured on half of the images and add up to more than the whole of the others: each
// contains a call of the clock.
//
// The images of one lap are rendered first: the robot drives round in a circle while its camera looks about,
// and after a lap everything is where it was. The lap is then repeated with stamps that go on.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "active_visual_memory/core/memory_pipeline.h"
#include "bench/vision/detectors.h"
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
  double minutes = 4.0;
  fs::path out = "out/bench-pipeline";
};

struct Lap {
  std::vector<RobotObservation> observations;
};

Lap render(const Options& options, const CameraMount& mount) {
  const World world = loadWorld(kRoot / "cfg/worlds" / (options.world + ".world")).world;
  Renderer renderer(world);
  const SimulatedCameraParams camera;
  ImageErrors errors(camera.errors, 1);
  Lap lap;
  const int images = static_cast<int>(std::lround(options.lap_s * options.rate_hz));
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

/// CPU of the published detector on each image of the lap, from the grey image on [ms].
class Peer {
 public:
  explicit Peer(const Lap& lap) {
    for (const RobotObservation& o : lap.observations) {
      cv::Mat grey;
      cv::cvtColor(o.frame.image, grey, cv::COLOR_RGB2GRAY);
      grey_.push_back(grey);
    }
    for (const DetectorEntry& entry : measuredDetectors()) {
      if (entry.name == kTunedEdLines) detector_ = entry.make();
    }
  }
  void run(std::uint64_t frame) {
    const double before_s = CpuStages::now_s();
    detector_->run(grey_[frame % grey_.size()]);
    spent_s_ += CpuStages::now_s() - before_s;
    ++images_;
  }
  double mean_ms() const { return 1e3 * spent_s_ / static_cast<double>(images_); }

 private:
  std::vector<cv::Mat> grey_;
  std::unique_ptr<MeasuredDetector> detector_;
  double spent_s_ = 0.0;
  std::uint64_t images_ = 0;
};

/// The iterations of a minute, or of the whole run.
class Iterations {
 public:
  void add(double ms, std::size_t elements) {
    ms_.push_back(ms);
    elements_ += static_cast<double>(elements);
  }
  std::size_t size() const { return ms_.size(); }
  Minute summary(double minutes) {
    std::sort(ms_.begin(), ms_.end());
    Minute result;
    result.minutes = minutes;
    const auto count = static_cast<double>(ms_.size());
    for (const double ms : ms_) result.mean_ms += ms / count;
    result.p99_ms = ms_[ms_.size() * 99 / 100];
    result.elements = elements_ / count;
    result.resident_mb = residentMb();
    return result;
  }

 private:
  std::vector<double> ms_;
  double elements_ = 0.0;
};

struct Run {
  std::map<std::string, double> stage_ms;
  std::vector<Minute> minutes;
  Minute all;
  double peer_ms = 0.0;
};

/// The lap again and again, each image through the pipeline, localization and the peer.
Run measure(const Options& options, const EvaluationParams& params) {
  const Lap lap = render(options, params.assembler.mount);
  MemoryPipeline pipeline(params.pipeline, params.palette);
  Localizer localizer(params.localizer, params.map_edges, 1);
  localizer.setPose(lap.observations.front().T_odom_robot);
  Peer peer(lap);
  CpuStages stages;
  Run run;
  Iterations all;
  Iterations minute;
  const auto total = static_cast<std::uint64_t>(std::llround(options.minutes * 60.0 * options.rate_hz));
  const auto per_minute =
      std::max<std::size_t>(1, std::llround(std::min(1.0, options.minutes) * 60.0 * options.rate_hz));
  for (std::uint64_t frame = 0; frame < total; ++frame) {
    RobotObservation o = lap.observations[frame % lap.observations.size()];
    o.frame.seq = frame;
    o.frame.stamp_us = toStampUs(static_cast<double>(frame + 1) / options.rate_hz);
    // The clock of the stages costs as much as a small stage: one second is measured by stage, the next one
    // as a whole; in the next lap the other way round.
    const auto second = static_cast<std::uint64_t>(static_cast<double>(frame) / options.rate_hz);
    const bool by_stage = (second + frame / lap.observations.size()) % 2 == 0;
    const double before_s = CpuStages::now_s();
    const auto& result = pipeline.process(o, by_stage ? &stages : nullptr);
    if (by_stage) stages.enter("localization");
    localizer.update(result.update);
    if (by_stage) stages.enter("outside");
    const double ms = 1e3 * (CpuStages::now_s() - before_s);
    peer.run(frame);
    if (!by_stage) {
      all.add(ms, result.update.snapshot->segments.size());
      minute.add(ms, result.update.snapshot->segments.size());
    }
    if ((frame + 1) % per_minute != 0) continue;
    run.minutes.push_back(minute.summary(static_cast<double>(frame + 1) / options.rate_hz / 60.0));
    minute = Iterations();
  }
  for (const auto& [stage, seconds] : stages.seconds()) {
    if (stage != "outside") run.stage_ms[stage] = 1e3 * seconds / static_cast<double>(total - all.size());
  }
  run.all = all.summary(options.minutes);
  run.peer_ms = peer.mean_ms();
  return run;
}

nlohmann::json report(const Options& options, const Run& run) {
  double load[1] = {0.0};
  if (getloadavg(load, 1) != 1) load[0] = std::nan("");
  std::printf(
      "`%s`, %s mode, 320x240 at %.0f Hz, %.0f elements; CPU from image to pose, one thread; load %.1f\n\n",
      options.world.c_str(), options.mode.c_str(), options.rate_hz, run.all.elements, load[0]);
  std::printf("| stage | ms | of tuned EDLines |\n|---|---|---|\n");
  const auto row = [&](const std::string& name, double ms) {
    std::printf("| %s | %.3f | %.3f |\n", name.c_str(), ms, ms / run.peer_ms);
  };
  for (const auto& [stage, ms] : run.stage_ms) row(stage, ms);
  row("image to pose", run.all.mean_ms);
  row("tuned EDLines", run.peer_ms);
  std::printf("\n");
  printTable(run.minutes);
  nlohmann::json json{{"world", options.world},
                      {"mode", options.mode},
                      {"elements", run.all.elements},
                      {"stage_ms", run.stage_ms},
                      {"mean_ms", run.all.mean_ms},
                      {"p99_ms", run.all.p99_ms},
                      {"edlines_ms", run.peer_ms},
                      {"of_edlines", run.all.mean_ms / run.peer_ms},
                      {"share_of_a_core_at_30_hz", run.all.mean_ms * 30.0 / 1e3},
                      {"load", load[0]}};
  json.update(toJson(run.minutes));
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "CPU from an image to the pose by stage, beside tuned EDLines on the same images, and over simulated "
      "minutes; the last line is JSON.",
      "bench pipeline");
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
  cv::setNumThreads(1);  // the CPU of other threads is not counted
  try {
    EvaluationOptions evaluation;
    evaluation.world = kRoot / "cfg/worlds" / (options.world + ".world");
    evaluation.map = kRoot / "cfg/maps" / (options.world + ".csv");
    evaluation.mode = options.mode;
    const Run run = measure(options, loadParams(evaluation, true));
    nlohmann::json json = report(options, run);
    if (!options.out.empty()) {
      fs::create_directories(options.out);
      writeCsv(run.minutes, options.out / "over_time.csv");
      writeFigure(run.minutes,
                  "From image to pose over time: `" + options.world + "`, " + options.mode + " mode",
                  options.out / "over_time.png");
      json["out"] = options.out.string();
    }
    std::cout << std::endl << json.dump() << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "bench pipeline: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
