#include "application/app/report_writer.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "application/core/image_figure.h"
#include "application/core/top_view.h"
#include "common/geometry/angles.h"
#include "evaluation/core/trajectory_io.h"
#include "evaluation/figures/error_figure.h"

namespace vismem {
namespace {

/// @param parts 1000 keeps three decimals. Dividing gives the double with the shortest text.
nlohmann::json rounded(std::optional<double> value, double parts = 1e4) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return std::round(*value * parts) / parts;
}

template <typename Write>
void writeStream(const std::filesystem::path& file, Write write) {
  std::ostringstream text;
  write(text);
  writeTextFile(file, text.str());
}

void writePng(const std::filesystem::path& file, const cv::Mat& rgb) {
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  if (!cv::imwrite(file.string(), bgr)) throw std::runtime_error("cannot write " + file.string());
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

void writeReport(const RunOptions& options, const RunRecord& record, const RunSummary& summary,
                 const RunMap& map) {
  const auto& out = options.out;
  writeStream(out / "trajectory.tum", [&](std::ostream& s) { writeTum(publishedTrajectory(record), s); });
  writeStream(out / "odometry.tum", [&](std::ostream& s) { writeTum(record.odometry, s); });
  if (!record.truth.empty()) {
    writeStream(out / "truth.tum", [&](std::ostream& s) { writeTum(record.truth, s); });
  }
  writeStream(out / "memory.csv",
              [&](std::ostream& s) { writeMemoryCsv(record.memory ? *record.memory : MemorySnapshot{}, s); });
  writeStream(out / "primitives.csv", [&](std::ostream& s) {
    writePrimitivesCsv(record.memory ? *record.memory : MemorySnapshot{}, s);
  });
  writeStream(out / "races.csv", [&](std::ostream& s) { writeRacesCsv(record.estimates, s); });

  const std::string title =
      titleOf(options) + (summary.score.is_twin ? " (the map looks the same from the twin place)" : "");
  writePng(out / "top_view.png", drawTopView(topViewOf(record, summary, map.map, title)));
  if (!record.truth.empty()) {
    writePng(out / "error.png", drawErrors({title + ": error over time", summary.score, {}}));
  }
  if (record.last_analysis) {
    char when[40];
    std::snprintf(when, sizeof when, ": image at %.2f s", toSeconds(record.last_analysis->stamp_us));
    if (const auto figure = imageFigureOf(record, map.edges, title + when)) {
      writePng(out / "last_image.png", drawLastImage(*figure));
    }
  }
  writeTextFile(out / "result.json", resultJson(options, summary).dump(2) + "\n");
}

}  // namespace vismem
