// scripts/bench odometry: growth of the dead-reckoned error of each preset with the distance, beside the
// documented formula, as a table, a figure and JSON.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "common/kinematics/kinematics.h"
#include "common/kinematics/odometry.h"
#include "common/kinematics/random_stream.h"
#include "common/routes/route_follower.h"
#include "common/tool/command_line_tool.h"
#include "evaluation/figures/canvas.h"
#include "support/odometry_error.h"

namespace {

using namespace vismem;
namespace fs = std::filesystem;

constexpr int kLength_m = 20;
constexpr double kStep_m = 0.005;
const double kBase_m = BaseParams{}.wheel_base_m;

struct Preset {
  std::string name;
  OdometryErrorParams errors;
  Rgb color;
};
const std::vector<Preset>& presets() {
  static const std::vector<Preset> kPresets{{"none", noOdometryError(), colors::kTruth},
                                            {"default", defaultOdometryError(), colors::kEstimate},
                                            {"stage", stageOdometryError(), colors::kOdometry},
                                            {"thrun", thrunOdometryError(), colors::kMemory}};
  return kPresets;
}

/// Position error after every metre of a straight way [m].
std::vector<double> straightRun(const OdometryErrorParams& errors, std::uint64_t seed) {
  SimulatedOdometry odometry(errors, kBase_m, subStream(seed, "odometry"));
  std::vector<double> result{0.0};
  for (int metre = 1; metre <= kLength_m; ++metre) {
    for (int i = 0; i < std::lround(1.0 / kStep_m); ++i) odometry.add({kStep_m, kStep_m});
    result.push_back((odometry.pose().position() - Eigen::Vector2d(metre, 0.0)).norm());
  }
  return result;
}

std::vector<double> rms(const std::vector<std::vector<double>>& runs) {
  std::vector<double> result(kLength_m + 1, 0.0);
  for (int metre = 0; metre <= kLength_m; ++metre) {
    double squares = 0.0;
    for (const auto& run : runs) squares += run[metre] * run[metre];
    result[metre] = std::sqrt(squares / static_cast<double>(runs.size()));
  }
  return result;
}

/// One round of the corridor's ring: the true path and the dead-reckoned one.
std::pair<std::vector<Eigen::Vector2d>, std::vector<Eigen::Vector2d>> ring(std::uint64_t seed) {
  const Route route{{{4.25, -2.25}, {4.25, 2.25}, {-4.25, 2.25}, {-4.25, -2.25}}, true};
  SimulatedOperator driver(route, {});
  const Pose2 start{0.0, -2.25, 0.0};
  SimulatedBase base(BaseParams{}, start, {});
  SimulatedOdometry odometry(defaultOdometryError(), kBase_m, subStream(seed, "odometry"));
  std::vector<Eigen::Vector2d> truth, reckoned;
  for (StampUs now = 0; now < 98 * kSecondUs; now += 10'000) {
    if (now % 50'000 == 0) {
      const DriveCommand command = driver.drive(base.pose());
      base.command(command.v_mps, command.w_radps, now);
    }
    odometry.add(base.step(now, 0.01));
    if (now % 200'000 == 0) {
      truth.push_back(base.pose().position());
      reckoned.push_back((start * odometry.pose()).position());
    }
  }
  return {truth, reckoned};
}

void drawGrowth(Canvas& canvas, const std::vector<std::vector<double>>& means,
                const std::vector<std::vector<double>>& singles) {
  constexpr double kLeft = 60, kRight = 470, kTop = 70, kBottom = 400, kMost_m = 6.0;
  const auto at = [&](double metre, double error) {
    return Eigen::Vector2d(kLeft + (kRight - kLeft) * metre / kLength_m,
                           kBottom - (kBottom - kTop) * std::min(error, kMost_m) / kMost_m);
  };
  for (int e = 0; e <= 6; ++e) {
    canvas.line(at(0, e), at(kLength_m, e), colors::kGrid);
    canvas.text(std::to_string(e), at(0, e) + Eigen::Vector2d(-8, 4), 9, colors::kInk, Align::kRight);
  }
  for (int m = 0; m <= kLength_m; m += 5) {
    canvas.text(std::to_string(m), at(m, 0) + Eigen::Vector2d(0, 18), 9, colors::kInk, Align::kCentre);
  }
  canvas.text("error of the position after a straight way [m]", {kLeft, kTop - 12}, 10, colors::kInk,
              Align::kLeft, true);
  canvas.text("way [m]", {0.5 * (kLeft + kRight), kBottom + 38}, 10, colors::kInk, Align::kCentre);
  const auto curve = [&](const std::vector<double>& errors, Rgb color, double width) {
    std::vector<Eigen::Vector2d> points;
    for (int m = 0; m <= kLength_m; ++m) points.push_back(at(m, errors[m]));
    canvas.polyline(points, color, width);
  };
  canvas.restrictTo({kLeft, kTop}, {kRight, kBottom + 2});
  for (const auto& run : singles) curve(run, {190, 205, 235}, 0.8);
  for (std::size_t i = 0; i < means.size(); ++i) curve(means[i], presets()[i].color, 2.2);
  for (int m = 0; m < kLength_m; ++m) {
    const auto& errors = presets()[1].errors;
    canvas.dashedLine(at(m, expectedStraightError_m(errors, kBase_m, m)),
                      at(m + 1, expectedStraightError_m(errors, kBase_m, m + 1)), colors::kInk, 1.4);
  }
  canvas.release();
  double v = kTop + 20;
  for (const auto& preset : presets()) {
    canvas.line({kLeft + 14, v - 4}, {kLeft + 40, v - 4}, preset.color, 2.2);
    canvas.text(preset.name + (preset.name == "default" ? " (thin: single runs; dashed: formula)" : ""),
                {kLeft + 48, v}, 9);
    v += 18;
  }
}

void drawRing(Canvas& canvas, int runs) {
  const Eigen::Vector2d middle(745, 235);
  constexpr double kScale = 36.0;
  const auto at = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(middle + kScale * Eigen::Vector2d(p.x(), -p.y()));
  };
  const auto path = [&](const std::vector<Eigen::Vector2d>& points, Rgb color, double width) {
    std::vector<Eigen::Vector2d> drawn;
    for (const auto& p : points) drawn.push_back(at(p));
    canvas.polyline(drawn, color, width);
  };
  canvas.text("default: once round the corridor, " + std::to_string(runs) + " seeds", {520, 58}, 10,
              colors::kInk, Align::kLeft, true);
  std::vector<Eigen::Vector2d> truth;
  for (int seed = 1; seed <= runs; ++seed) {
    const auto [true_path, reckoned] = ring(seed);
    path(reckoned, {120, 160, 230}, 1.0);
    canvas.disc(at(reckoned.back()), 3.0, colors::kEstimate);
    truth = true_path;
  }
  path(truth, colors::kTruth, 2.2);
  canvas.line({520, 420}, {520 + kScale, 420}, colors::kInk, 2.0);
  canvas.text("1 m; green: the true path", {520 + kScale + 8, 424}, 9);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("How the dead-reckoned error of each odometry preset grows: table, figure, JSON last.",
               "bench odometry");
  fs::path out = "out/bench-odometry";
  int runs = 1000;
  app.add_option("--out", out, "folder of odometry_error.png");
  app.add_option("--runs", runs, "seeds of the means")->check(CLI::Range(20, 1'000'000));
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  std::vector<std::vector<double>> means, singles;
  for (const auto& preset : presets()) {
    std::vector<std::vector<double>> all;
    for (int seed = 1; seed <= runs; ++seed) all.push_back(straightRun(preset.errors, seed));
    means.push_back(rms(all));
    if (preset.name == "default") singles.assign(all.begin(), all.begin() + 20);
  }
  nlohmann::json json;
  json["runs"] = runs;
  std::printf("Root mean square of the position's error [m] after a straight way, %d runs\n\n", runs);
  std::printf("| way | none | default | formula | stage | thrun |\n|---|---|---|---|---|---|\n");
  for (const int metre : {1, 2, 5, 10, 20}) {
    const double formula = expectedStraightError_m(presets()[1].errors, kBase_m, metre);
    std::printf("| %d m | %.3f | %.3f | %.3f | %.3f | %.3f |\n", metre, means[0][metre], means[1][metre],
                formula, means[2][metre], means[3][metre]);
    json["formula_m"][std::to_string(metre)] = formula;
    for (std::size_t i = 0; i < means.size(); ++i) {
      json["rms_m"][presets()[i].name][std::to_string(metre)] = means[i][metre];
    }
  }
  Canvas canvas(980, 450);
  canvas.text("Dead reckoning of the simulated base, by preset", {60, 30}, 13, colors::kInk, Align::kLeft,
              true);
  drawGrowth(canvas, means, singles);
  drawRing(canvas, 12);
  cv::Mat picture = canvas.finish();
  cv::cvtColor(picture, picture, cv::COLOR_RGB2BGR);
  fs::create_directories(out);
  const fs::path file = out / "odometry_error.png";
  if (!cv::imwrite(file.string(), picture)) {
    std::cerr << "bench odometry: " << file.string() << " cannot be written\n";
    return 1;
  }
  json["figure"] = file.string();
  std::cout << std::endl << json.dump() << std::endl;
  return 0;
}
