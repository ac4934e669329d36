#include "application/app/report_writer.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/geometry/angles.h"
#include "evaluation/core/trajectory_io.h"

namespace vismem {
namespace {

/// @param parts 1000 keeps three decimals. Dividing gives the double with the shortest text.
nlohmann::json rounded(std::optional<double> value, double parts = 1e4) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return std::round(*value * parts) / parts;
}

std::string titleOf(const RunOptions& options) {
  if (options.setup == Setup::kReplay) return "recording " + options.bag.stem().string();
  return "world " + options.world.stem().string() + ", seed " + std::to_string(options.seed);
}

}  // namespace

nlohmann::json resultJson(const RunOptions& options, const RunSummary& summary) {
  const LocalizationScore& score = summary.score;
  std::optional<double> heading_deg;
  if (score.heading_error_rad) heading_deg = radToDeg(*score.heading_error_rad);
  nlohmann::json result;
  result["setup"] = options.folder;
  result["seed"] = options.seed;
  result["out"] = options.out.string();
  result["seconds"] = rounded(summary.seconds, 1e3);
  result["distance_m"] = rounded(summary.distance_m, 1e3);
  result["position_error_m"] = rounded(score.position_error_m);
  result["heading_error_deg"] = rounded(heading_deg);
  result["settled_after_s"] = rounded(score.settled_after_s, 1e3);
  // Unknown without a truth.
  result["recovered"] = score.errors.empty() ? nlohmann::json(nullptr) : nlohmann::json(score.recovered);
  result["map_symmetries"] = summary.map_symmetries;
  result["is_twin"] = score.is_twin;
  result["memory_segments"] = summary.memory_segments;
  result["memory_hz"] = rounded(summary.memory_hz, 1e2);
  result["camera_hz"] = rounded(summary.camera_hz, 1e2);
  if (options.setup == Setup::kSimulation) {
    result["world"] = options.world.stem().string();
  } else {
    result["bag"] = options.bag.stem().string();
  }
  if (summary.projection) {
    result["map_projection_px"] = rounded(summary.projection->detected_to_map_px, 1e2);
    result["map_to_detected_px"] = rounded(summary.projection->map_to_detected_px, 1e2);
    result["judged_images"] = summary.projection->images;
    result["images_without_lines"] = summary.projection->images_without_lines;
    result["images_without_pose"] = summary.projection->images_without_pose;
  }
  return result;
}

std::vector<std::string> writeReport(const RunOptions& options, RunFiles& files, const RunRecord& record,
                                     const RunSummary& summary, const RunMap& map) {
  files.finish(record.memory.get());
  std::vector<std::string> problems = files.problems();
  const auto unwritten = writePictures(options.out, record, summary, map, titleOf(options));
  problems.insert(problems.end(), unwritten.begin(), unwritten.end());
  try {
    writeTextFile(options.out / "result.json", resultJson(options, summary).dump(2) + "\n");
  } catch (const std::runtime_error& error) {
    problems.emplace_back(error.what());
  }
  return problems;
}

}  // namespace vismem
