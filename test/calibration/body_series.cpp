/// @file body_series: `calibrate body` on robots drawn by seed, corner observations by a camera model. See
/// its
/// --help.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "calibration/simulated_body_trial.h"
#include "common/geometry/angles.h"
#include "common/kinematics/random_stream.h"
#include "common/tool/command_line_tool.h"
#include "support/lens_trials.h"

namespace vismem {
namespace {

using Json = nlohmann::json;

struct SeriesOptions {
  std::filesystem::path table;
  std::uint64_t first = 1;
  int count = 20;
  double wheel_noise_m = -1.0;
  double noise = 1.0;
  int rounds = BodyDriveParams{}.rounds;
  bool is_rendered = false;
  bool is_lens_calibrated = false;
};

/// The demands on one robot: name, its value in a row, and the limit of its absolute value.
struct Demand {
  const char* name;
  double limit;
};
constexpr Demand kDemands[] = {{"tilt_deg", 0.05},
                               {"height_mm", 2.0},
                               {"x_mm", 3.0},
                               {"y_mm", 3.0},
                               {"yaw_deg", 0.15},
                               {"pan_scale_percent", 0.1},
                               {"tilt_scale_percent", 0.1},
                               {"pan_backlash_deg", 0.05},
                               {"tilt_backlash_deg", 0.05},
                               {"joint_delay_ms", 2.0},
                               {"odometry_delay_ms", 10.0},
                               {"ring_m", 0.08}};

void addErrors(const BodyEstimate& estimate, const TrueRobot& truth, Json& row) {
  const BodyErrors e = errorsOf(estimate.parameters, truth);
  static constexpr const char* kPlace[] = {"x_mm", "y_mm", "height_mm", "roll_deg", "tilt_deg", "yaw_deg"};
  double squares = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double error = e.place[static_cast<Eigen::Index>(i)];
    const auto& sigma = estimate.place[i].sigma;
    row[kPlace[i]] = error * cameraPlaceInfos()[i].to_unit;
    row["sigma"][kPlace[i]] = sigma ? Json(*sigma * cameraPlaceInfos()[i].to_unit) : Json();
    squares += sigma ? std::pow(error / *sigma, 2) / 6.0 : NAN;
  }
  row["normalised"] = std::sqrt(squares);
  row["fx_px"] = estimate.parameters.lens[kFx];
  row["worst_angle_deg"] = radToDeg(e.worst_angle_rad);
  row["pan_scale_percent"] = 100 * e.pan_scale;
  row["tilt_scale_percent"] = 100 * e.tilt_scale;
  row["pan_backlash_deg"] = radToDeg(e.backlash_rad.x());
  row["tilt_backlash_deg"] = radToDeg(e.backlash_rad.y());
  row["joint_delay_ms"] = 1e3 * e.joint_delay_s;
  row["odometry_delay_ms"] = 1e3 * e.odometry_delay_s;
  row["row_time_us"] = 1e6 * e.row_time_s;
  row["ring_m"] = e.ring_m;
  row["ring_before_m"] = e.ring_before_m;
  row["corner_noise"] = estimate.noise.corners;
  row["wheel_noise_m"] = estimate.noise.wheel_sqrtm;
  row["repeatability_deg"] = radToDeg(estimate.noise.repeatability_rad);
  row["rms_px"] = estimate.fit.rms_px;
  const BodyParameters sought = soughtParameters(truth);
  for (const auto& r : estimate.rows) {
    const ParameterInfo& info = parameterInfos()[r.index];
    if (r.sigma)
      row["errors_in_sigmas"][std::string(info.name)] = (r.value - parameterOf(sought, r.index)) / *r.sigma;
    row["sigma"][std::string(info.name)] = r.sigma ? Json(*r.sigma * info.to_unit) : Json();
  }
  for (const auto& direction : estimate.unknown) row["unknown"].push_back(direction.text);
  for (const auto& warning : estimate.warnings) row["warnings"].push_back(warning);
}

/// A lens drawn by seed, stated as `calibrate lens` finds it from views that a user shows it.
void drawCalibratedLens(TrueRobot& truth, std::uint64_t seed) {
  std::mt19937 random(static_cast<unsigned>(subStream(seed, "lens")));
  do {
    truth.intrinsics = drawLens(random);
  } while (horizontalView_rad(truth.intrinsics) > degToRad(90.0));
  const CameraIntrinsics& k = truth.intrinsics;
  BoardHolder holder(k, truth.board, false, static_cast<unsigned>(random()));
  LensSessionParams params;
  params.max_motion_px = 0.0;  // each view is another one
  LensSession session(truth.board, k.width, k.height, params);
  holder.hold(session, 200);
  const auto found = calibrateLens(truth.board, session.views(), k.width, k.height);
  if (!found.calibration) throw std::runtime_error("no lens: " + found.refusal);
  truth.stated = found.calibration->fit.lens;
}

SimulatedBodyTrial modelledTrial(const TrueRobot& truth, std::uint64_t seed, const SeriesOptions& options) {
  SimulatedBoardRobot robot(truth, seed);
  BodyDriveParams params = driveInSimulator();
  if (!options.is_lens_calibrated) {
    params = {};
    params.rig.mount = describedMount();
  }
  params.rounds = options.rounds;
  SimulatedBodyTrial trial{{}, BodyDrive(params), 0.0, 0.0};
  trial.record = robot.run(trial.drive);
  trial.farthest_m = robot.farthest();
  trial.seconds = robot.seconds();
  return trial;
}

SimulatedBodyTrial renderedTrial(const TrueRobot& truth, std::uint64_t seed, const SeriesOptions& options) {
  BodyDriveParams params = driveInSimulator();
  params.rounds = options.rounds;
  return runInSimulator(truth, seed, params);
}

Json calibrateDrawn(std::uint64_t seed, const SeriesOptions& options) {
  TrueRobot truth = options.is_rendered ? drawnForSimulator(seed) : drawnRobot(seed);
  if (options.is_lens_calibrated) {
    truth.board = a2Board();
    truth.start.x = -0.9;
    drawCalibratedLens(truth, seed);
  }
  if (options.wheel_noise_m >= 0.0) truth.wheel_noise_sqrtm = options.wheel_noise_m;
  truth.corner_sigma_px *= options.noise;
  truth.repeatability_rad *= options.noise;
  truth.wheel_noise_sqrtm *= options.noise;
  const SimulatedBodyTrial trial =
      options.is_rendered ? renderedTrial(truth, seed, options) : modelledTrial(truth, seed, options);
  const BodyRecord& record = trial.record;
  Json row{{"seed", seed},
           {"stopped", trial.drive.whyStopped()},
           {"seconds", trial.seconds},
           {"views", record.views.size()},
           {"farthest_m", trial.farthest_m}};
  try {
    BodyEstimatorParams params;
    params.mount = describedMount();
    params.wheel_base_m = kDescribedBase_m;
    addErrors(estimateBody(record, params), truth, row);
  } catch (const std::exception& error) {
    row["failed"] = error.what();
  }
  return row;
}

std::map<std::uint64_t, Json> readRows(const std::filesystem::path& table) {
  std::map<std::uint64_t, Json> rows;
  std::ifstream in(table);
  for (std::string line; std::getline(in, line);) {
    Json row = Json::parse(line, nullptr, false);
    if (row.is_object() && row.contains("seed")) rows[row["seed"].get<std::uint64_t>()] = row;
  }
  return rows;
}

Json summaryOf(const std::map<std::uint64_t, Json>& rows, const SeriesOptions& options) {
  Json summary;
  int all = 0;
  int good = 0;
  std::map<std::string, int> met;
  std::map<std::string, double> worst;
  for (std::uint64_t seed = options.first; seed < options.first + static_cast<std::uint64_t>(options.count);
       ++seed) {
    const Json& row = rows.at(seed);
    bool every = true;
    for (const Demand& demand : kDemands) {
      const double value = row.contains(demand.name) ? std::abs(row[demand.name].get<double>()) : NAN;
      const bool is_met = value <= demand.limit;
      met[demand.name] += is_met ? 1 : 0;
      worst[demand.name] = std::max(worst[demand.name], value);
      every = every && is_met;
    }
    ++all;
    good += every ? 1 : 0;
  }
  for (const Demand& demand : kDemands) {
    summary["met"][demand.name] = met[demand.name];
    summary["worst"][demand.name] = worst[demand.name];
  }
  summary["robots"] = all;
  summary["every_demand"] = good;
  return summary;
}

int run(const SeriesOptions& options) {
  auto rows = readRows(options.table);
  std::ofstream out(options.table, std::ios::app);
  for (int i = 0; i < options.count; ++i) {
    const std::uint64_t seed = options.first + static_cast<std::uint64_t>(i);
    if (rows.count(seed) != 0) continue;
    rows[seed] = calibrateDrawn(seed, options);
    out << rows[seed].dump() << std::endl;
    std::cerr << "robot " << seed << " done\n";
  }
  std::cout << summaryOf(rows, options).dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace vismem

int main(int argc, char** argv) {
  vismem::SeriesOptions options;
  CLI::App app(
      "Calibrates robots drawn by seed and compares with the truth: one JSON line a robot in a table, how "
      "many "
      "meet each demand on the last line. Robots that the table has are not repeated.",
      "body_series");
  app.add_option("--table", options.table, "file of JSON lines")->required();
  app.add_option("--first", options.first, "first seed")->capture_default_str();
  app.add_option("--count", options.count, "number of robots")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--wheel-noise", options.wheel_noise_m,
                 "of each wheel after one metre [m] (default 0.0005)");
  app.add_option("--noise", options.noise,
                 "factor of the noise of corners, joints and wheels: with 0.01, errors are those of the model")
      ->capture_default_str();
  app.add_flag("--rendered", options.is_rendered,
               "corners found in the simulator's images of a larger board");
  app.add_flag("--calibrated-lens", options.is_lens_calibrated,
               "lenses are drawn, and stated as calibrate lens finds them; without it: known to a pixel, no "
               "distortion");
  app.add_option("--rounds", options.rounds, "around the board, each way")->capture_default_str();
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  return vismem::run(options);
}
