#include "over_time.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/config/text_format.h"
#include "common/vision/app/image_file.h"
#include "evaluation/figures/canvas.h"
#include "experiments/app/experiment_files.h"

namespace vismem {
namespace {

/// A value over the minutes, from 0 up.
void drawPanel(Canvas& canvas, const std::vector<Minute>& minutes, double Minute::*value,
               double Minute::*above, const std::string& title, const Eigen::Vector2d& low,
               const Eigen::Vector2d& size) {
  double most = 0.0;
  for (const Minute& m : minutes) most = std::max({most, m.*value, above ? m.*above : 0.0});
  const double step = std::pow(10.0, std::floor(std::log10(std::max(most, 1e-6))));
  const double top = std::ceil(most / step) * step;
  const auto px = [&](double minute, double v) {
    return Eigen::Vector2d(low.x() + size.x() * minute / minutes.back().minutes,
                           low.y() + size.y() * (1.0 - v / top));
  };
  canvas.text(title, low - Eigen::Vector2d(0.0, 8.0), 10.0);
  for (int i = 0; i <= 4; ++i) {
    const double v = top * i / 4.0;
    canvas.line(px(0.0, v), px(minutes.back().minutes, v), colors::kGrid);
    canvas.text(formatted("%.3g", v), px(0.0, v) + Eigen::Vector2d(-6.0, 4.0), 9.0, colors::kFaintInk,
                Align::kRight);
  }
  const auto draw = [&](double Minute::*which, Rgb color) {
    std::vector<Eigen::Vector2d> points;
    for (const Minute& m : minutes) points.push_back(px(m.minutes, m.*which));
    canvas.polyline(points, color, 1.6);
  };
  if (above) draw(above, colors::kOdometry);
  draw(value, colors::kEstimate);
  canvas.text(formatted("%.0f min", minutes.back().minutes),
              px(minutes.back().minutes, 0.0) + Eigen::Vector2d(0.0, 15.0), 9.0, colors::kFaintInk,
              Align::kRight);
}

}  // namespace

void printTable(const std::vector<Minute>& minutes) {
  std::printf(
      "| robot time [min] | mean [ms] | 99 %% [ms] | elements | resident [MB] |\n|---|---|---|---|---|\n");
  const std::size_t every = (minutes.size() + 11) / 12;
  for (std::size_t i = every; i <= minutes.size(); i += every) {
    const Minute& m = minutes[i - 1];
    std::printf("| %.1f | %.3f | %.3f | %.0f | %.1f |\n", m.minutes, m.mean_ms, m.p99_ms, m.elements,
                m.resident_mb);
  }
}

void writeCsv(const std::vector<Minute>& minutes, const std::filesystem::path& file) {
  CsvFile csv(file, "minutes,mean_ms,p99_ms,elements,resident_mb");
  for (const Minute& m : minutes) {
    csv.row(formatted("%.2f,%.4f,%.4f,%.1f,%.2f", m.minutes, m.mean_ms, m.p99_ms, m.elements, m.resident_mb));
  }
  csv.close();
}

void writeFigure(const std::vector<Minute>& minutes, const std::string& title,
                 const std::filesystem::path& file) {
  if (minutes.empty()) return;
  Canvas canvas(760, 470);
  canvas.text(title, {18.0, 28.0}, 13.0, colors::kInk, Align::kLeft, true);
  const Eigen::Vector2d size(660.0, 140.0);
  drawPanel(canvas, minutes, &Minute::mean_ms, &Minute::p99_ms,
            "CPU of one iteration [ms]: mean (blue) and 99 % (orange) of each minute", {70.0, 80.0}, size);
  drawPanel(canvas, minutes, &Minute::resident_mb, nullptr, "resident memory [MB]", {70.0, 285.0}, size);
  writeImageFile(canvas.finish(), file);
}

nlohmann::json toJson(const std::vector<Minute>& minutes) {
  nlohmann::json json;
  for (const Minute& m : minutes) {
    json["over_time"].push_back({{"minutes", m.minutes},
                                 {"mean_ms", m.mean_ms},
                                 {"p99_ms", m.p99_ms},
                                 {"elements", m.elements},
                                 {"resident_mb", m.resident_mb}});
  }
  const std::size_t quarter = minutes.size() / 4;
  if (quarter == 0) return json;
  const auto mean = [&](std::size_t first, double Minute::*value) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + quarter; ++i) sum += minutes[i].*value;
    return sum / static_cast<double>(quarter);
  };
  const std::size_t last = minutes.size() - quarter;
  json["growth_ms"] = mean(last, &Minute::mean_ms) - mean(quarter, &Minute::mean_ms);
  json["growth_mb"] = mean(last, &Minute::resident_mb) - mean(quarter, &Minute::resident_mb);
  return json;
}

}  // namespace vismem
