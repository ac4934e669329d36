#include "experiments/app/trial_report.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"
#include "common/vision/app/image_file.h"
#include "evaluation/figures/canvas.h"
#include "evaluation/figures/error_figure.h"
#include "experiments/app/experiment_files.h"

namespace vismem {
namespace {

nlohmann::json finite(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json toJson(const std::optional<Figure>& figure, double scale = 1.0) {
  if (!figure) return nullptr;
  return {{"value", finite(scale * figure->value)},
          {"low", finite(scale * figure->interval.low)},
          {"high", finite(scale * figure->interval.high)}};
}

std::string shown(const std::optional<Figure>& figure, double scale, const char* format) {
  if (!figure) return "-";
  const auto one = [&](double value) {
    return std::isfinite(value) ? formatted(format, scale * value) : std::string("never");
  };
  return one(figure->value) + " (" + one(figure->interval.low) + ".." + one(figure->interval.high) + ")";
}

void printTable(const std::string& title, const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::cerr << title << "\n";
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
    }
    std::cerr << line.substr(0, line.find_last_not_of(' ') + 1) << "\n";
  }
}

/// Share of events recovered over the time since the kidnapping, a curve for each method.
cv::Mat drawRecovery(const std::string& title, const std::vector<MethodRecord>& records,
                     const SummaryParams& params) {
  constexpr int kWidth = 900;
  constexpr int kHeight = 520;
  constexpr double kLeft = 70.0;
  constexpr double kRight = 650.0;
  constexpr double kTop = 60.0;
  constexpr double kBottom = 460.0;
  Canvas canvas(kWidth, kHeight);
  canvas.text(title, {kLeft, 34.0}, 12.0, colors::kInk, Align::kLeft, true);
  const auto at = [&](double seconds, double share) {
    return Eigen::Vector2d(kLeft + (kRight - kLeft) * seconds / params.within_s,
                           kBottom - (kBottom - kTop) * share);
  };
  for (int i = 0; i <= 10; ++i) {
    const double share = 0.1 * i;
    canvas.line(at(0.0, share), at(params.within_s, share), colors::kGrid);
    canvas.text(formatted("%.0f %%", 100.0 * share), at(0.0, share) + Eigen::Vector2d(-8.0, 4.0), 8.5,
                colors::kFaintInk, Align::kRight);
  }
  for (int i = 0; i <= 6; ++i) {
    const double seconds = params.within_s * i / 6.0;
    canvas.line(at(seconds, 0.0), at(seconds, 1.0), colors::kGrid);
    canvas.text(formatted("%g s", seconds), at(seconds, 0.0) + Eigen::Vector2d(0.0, 18.0), 8.5,
                colors::kFaintInk, Align::kCentre);
  }
  for (std::size_t m = 0; m < records.size(); ++m) {
    std::vector<double> times;
    int events = 0;
    for (const EventScore& event : records[m].events) {
      if (params.kidnaps_only && event.event == 0) continue;
      ++events;
      if (event.settled_after_s && *event.settled_after_s <= params.within_s) {
        times.push_back(*event.settled_after_s);
      }
    }
    std::sort(times.begin(), times.end());
    std::vector<Eigen::Vector2d> curve{at(0.0, 0.0)};
    for (std::size_t i = 0; i < times.size(); ++i) {
      curve.push_back(at(times[i], static_cast<double>(i) / events));
      curve.push_back(at(times[i], static_cast<double>(i + 1) / events));
    }
    curve.push_back(at(params.within_s, events > 0 ? static_cast<double>(times.size()) / events : 0.0));
    const Rgb color = categoryColor(static_cast<int>(m));
    canvas.polyline(curve, color, 2.0);
    const double v = kTop + 20.0 * static_cast<double>(m);
    canvas.line({kRight + 20.0, v}, {kRight + 50.0, v}, color, 2.5);
    canvas.text(records[m].name, {kRight + 58.0, v + 4.0}, 9.0);
  }
  canvas.rectangle({kLeft, kTop}, {kRight, kBottom}, colors::kFaintInk);
  canvas.text("share of events recovered", {kLeft, kTop - 8.0}, 9.0);
  return canvas.finish();
}

}  // namespace

nlohmann::json toJson(const TrialSummary& summary) {
  nlohmann::json json{{"events", summary.events},
                      {"seeds", summary.seeds},
                      {"recovered", summary.recovered},
                      {"recovered_share", toJson(std::optional<Figure>(summary.recovered_share))},
                      {"median_s", toJson(summary.median_s)},
                      {"p90_s", toJson(summary.p90_s)},
                      {"position_error_m", toJson(summary.position_error_m)},
                      {"median_position_error_m", toJson(summary.median_position_error_m)},
                      {"heading_error_deg", toJson(summary.heading_error_rad, radToDeg(1.0))},
                      {"inside_reported_95_share", toJson(summary.inside_reported)},
                      {"error_over_reported", toJson(summary.error_over_reported)},
                      {"wrong_at_end_share", summary.wrong_at_end}};
  if (summary.true_alive) json["true_place_alive_share"] = *summary.true_alive;
  if (summary.right_after_evidence) json["right_10_s_after_evidence"] = toJson(summary.right_after_evidence);
  return json;
}

Comparison::Comparison(std::string name, std::string title, const std::vector<std::string>& methods)
    : name_(std::move(name)), title_(std::move(title)) {
  for (const std::string& method : methods) records_.push_back({method, {}, {}});
}

void Comparison::add(const MethodOutcome& outcome) {
  const auto record = std::find_if(records_.begin(), records_.end(),
                                   [&](const MethodRecord& one) { return one.name == outcome.method; });
  if (record == records_.end()) {
    throw std::invalid_argument("comparison \"" + name_ + "\" has no method \"" + outcome.method + "\"");
  }
  record->events.insert(record->events.end(), outcome.events.begin(), outcome.events.end());
  record->cycle_ms.insert(record->cycle_ms.end(), outcome.cycle_ms.begin(), outcome.cycle_ms.end());
}

void drawErrorsOf(const TrialOutcome& trial, const std::string& method, const std::filesystem::path& file) {
  for (const RecordOutcome& record : trial.records) {
    for (const MethodOutcome& outcome : record.methods) {
      if (outcome.method != method || outcome.poses.empty()) continue;
      ErrorFigure figure;
      figure.title = formatted("%s, seed %llu: error over time", method.c_str(),
                               static_cast<unsigned long long>(trial.seed));
      figure.score = scoreLocalization(outcome.poses, record.truth, record.events_us);
      writeImageFile(drawErrors(figure), file);
    }
  }
}

nlohmann::json Comparison::write(const std::filesystem::path& out, const SummaryParams& params) const {
  std::string csv =
      "method,seed,event,settled_after_s,position_error_m,heading_error_deg,right_at_end,true_alive,"
      "evidence_after_s,inside_reported_95,error_over_reported\n";
  const auto number = [](const std::optional<double>& value, double scale = 1.0) {
    return value ? formatted("%.4f", scale * *value) : std::string();
  };
  nlohmann::json json;
  for (const MethodRecord& record : records_) {
    for (const EventScore& event : record.events) {
      csv += formatted("%s,%llu,%d,%s,%s,%s,%d,%s,%s,%s,%s\n", record.name.c_str(),
                       static_cast<unsigned long long>(event.seed), event.event,
                       number(event.settled_after_s).c_str(), number(event.position_error_m).c_str(),
                       number(event.heading_error_rad, radToDeg(1.0)).c_str(), event.right_at_end ? 1 : 0,
                       number(event.true_alive).c_str(), number(event.evidence_after_s).c_str(),
                       number(event.inside_reported).c_str(), number(event.error_over_reported).c_str());
    }
    json[record.name] = toJson(summarize(record.events, params));
    json[record.name]["cpu_ms_mean"] = mean(record.cycle_ms).value_or(0.0);
    json[record.name]["cpu_ms_p99"] = quantile(record.cycle_ms, 0.99).value_or(0.0);
  }
  replaceFile(out / (name_ + "_events.csv"), csv);
  replaceFile(out / (name_ + ".json"), json.dump(2) + "\n");
  return json;
}

nlohmann::json Comparison::report(const std::filesystem::path& out, const SummaryParams& params) const {
  nlohmann::json json = write(out, params);
  std::vector<std::vector<std::string>> rows{{"method", "recovered", "median s", "p90 s", "error cm",
                                              "median cm", "deg", "in reported 95 %", "error/reported",
                                              "wrong at end", "CPU ms, p99"}};
  const bool twins = std::any_of(records_.begin(), records_.end(), [](const MethodRecord& record) {
    return std::any_of(record.events.begin(), record.events.end(),
                       [](const EventScore& event) { return event.evidence_after_s.has_value(); });
  });
  if (twins) {
    rows.front().push_back("true place alive");
    rows.front().push_back("right 10 s after evidence");
  }
  for (const MethodRecord& record : records_) {
    const TrialSummary summary = summarize(record.events, params);
    rows.push_back({record.name,
                    formatted("%d/%d ", summary.recovered, summary.events) +
                        shown(summary.recovered_share, 100.0, "%.1f"),
                    shown(summary.median_s, 1.0, "%.1f"), shown(summary.p90_s, 1.0, "%.1f"),
                    shown(summary.position_error_m, 100.0, "%.1f"),
                    shown(summary.median_position_error_m, 100.0, "%.1f"),
                    shown(summary.heading_error_rad, radToDeg(1.0), "%.2f"),
                    shown(summary.inside_reported, 100.0, "%.1f"),
                    shown(summary.error_over_reported, 1.0, "%.2f"),
                    formatted("%.1f %%", 100.0 * summary.wrong_at_end),
                    formatted("%.2f, %.2f", json[record.name]["cpu_ms_mean"].get<double>(),
                              json[record.name]["cpu_ms_p99"].get<double>())});
    if (twins) {
      rows.back().push_back(summary.true_alive ? formatted("%.1f %%", 100.0 * *summary.true_alive) : "-");
      rows.back().push_back(shown(summary.right_after_evidence, 100.0, "%.1f"));
    }
  }
  printTable(title_, rows);
  writeImageFile(drawRecovery(title_, records_, params), out / (name_ + ".png"));
  return json;
}

}  // namespace vismem
