#include "status/core/status_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <ctime>

#include "common/geometry/rounding.h"

namespace vismem {
namespace {

constexpr double kMsPerSecond = 1e3;
/// Errors shown in the table; JSON has all that a component keeps.
constexpr std::size_t kShownErrors = 3;

constexpr const char* kGreen = "\033[32m";
constexpr const char* kYellow = "\033[33m";
constexpr const char* kRed = "\033[31m";
constexpr const char* kPlain = "\033[0m";

__attribute__((format(printf, 1, 2))) std::string formatted(const char* format, ...) {
  std::array<char, 160> text{};
  va_list values;
  va_start(values, format);
  std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  return text.data();
}

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

/// "12 s", "3:07", "2:03:07".
std::string durationText(double seconds) {
  const auto all = static_cast<long>(seconds);
  if (all < 60) return formatted("%ld s", all);
  if (all < 3600) return formatted("%ld:%02ld", all / 60, all % 60);
  return formatted("%ld:%02ld:%02ld", all / 3600, all / 60 % 60, all % 60);
}

std::string clockTime(std::int64_t stamp_us) {
  const auto seconds = static_cast<std::time_t>(stamp_us / 1'000'000);
  std::tm local{};
  localtime_r(&seconds, &local);
  return formatted("%02d:%02d:%02d", local.tm_hour, local.tm_min, local.tm_sec);
}

const char* colourOf(const std::string& state) {
  if (state == "running") return kGreen;
  if (state == "absent" || state == "silent") return kRed;
  return kYellow;
}

std::string reasonOf(const ComponentRow& row) {
  if (!row.report) return row.failure;
  return row.report->reason;
}

using Lines = std::vector<std::pair<std::string, std::string>>;

/// Details below a component's line: a heading (once for several lines of a kind) and a text.
Lines detailsOf(const StatusReport& report) {
  Lines lines;
  for (const auto& peer : report.peers) {
    std::string text = padded(peer.name, 14) + " ";
    const bool connected = peer.link == PeerState::Link::kConnected;
    text += connected ? "connected" : "away";
    if (peer.reconnections > 0) text += formatted(", reconnections: %d", peer.reconnections);
    text += "   " + peer.proxy;
    if (!connected && !peer.reason.empty()) text += " (" + peer.reason + ")";
    lines.emplace_back("peers", std::move(text));
  }
  for (const auto& rate : report.rates) {
    lines.emplace_back("rates", padded(rate.name, 14) + formatted(" %7.1f Hz %10lld in all", rate.hz,
                                                                  static_cast<long long>(rate.total)));
  }
  for (const auto& [name, figures] : report.latencies) {
    lines.emplace_back(
        "latencies",
        padded(name, 14) + formatted(" p50 %.1f  p95 %.1f  p99 %.1f  max %.1f ms",
                                     kMsPerSecond * figures.p50_s, kMsPerSecond * figures.p95_s,
                                     kMsPerSecond * figures.p99_s, kMsPerSecond * figures.max_s));
  }
  std::size_t gauge_width = 14;
  for (const auto& gauge : report.gauges) gauge_width = std::max(gauge_width, gauge.name.size());
  for (const auto& gauge : report.gauges) {
    lines.emplace_back("estimates", padded(gauge.name, gauge_width) +
                                        (gauge.sigma > 0.0 ? formatted(" %.2f +- %.2f ",
                                                                       rounded(gauge.value, 100), gauge.sigma)
                                                           : formatted(" %.1f ", gauge.value)) +
                                        gauge.unit);
  }
  const std::size_t skipped = report.errors.size() - std::min(report.errors.size(), kShownErrors);
  for (std::size_t i = skipped; i < report.errors.size(); ++i) {
    lines.emplace_back("last errors", clockTime(report.errors[i].stamp_us) + "  " + report.errors[i].text);
  }
  return lines;
}

}  // namespace

std::string stateName(const ComponentRow& row) {
  if (!row.report) return row.absent ? "absent" : "silent";
  return nameOf(row.report->state);
}

bool isWhole(const std::vector<ComponentRow>& rows) {
  return !rows.empty() && std::all_of(rows.begin(), rows.end(), [](const ComponentRow& row) {
    return row.report && row.report->state == RunState::kRunning;
  });
}

std::string statusTable(const std::vector<ComponentRow>& rows, bool colour) {
  std::size_t name_width = std::string("COMPONENT").size();
  std::size_t setup_width = std::string("SETUP").size();
  for (const auto& row : rows) {
    name_width = std::max(name_width, row.name.size());
    setup_width = std::max(setup_width, row.setup.size());
  }
  std::string table = padded("SETUP", setup_width) + "  " + padded("COMPONENT", name_width) +
                      "  STATE     UP         REASON\n";
  for (const auto& row : rows) {
    const std::string state = stateName(row);
    const std::string shown = padded(state, 8);
    table += padded(row.setup, setup_width) + "  " + padded(row.name, name_width) + "  " +
             (colour ? colourOf(state) + shown + kPlain : shown) + "  " +
             padded(row.report ? durationText(row.report->uptime_s) : "", 9) + "  " + reasonOf(row);
    while (table.back() == ' ') table.pop_back();
    table += '\n';
    if (!row.report) continue;
    std::string heading;
    for (const auto& [kind, text] : detailsOf(*row.report)) {
      table += "    " + padded(kind == heading ? "" : kind, 13) + text + '\n';
      heading = kind;
    }
  }
  return table;
}

nlohmann::json statusJson(const std::vector<ComponentRow>& rows) {
  nlohmann::json components = nlohmann::json::array();
  for (const auto& row : rows) {
    nlohmann::json component{{"setup", row.setup},
                             {"name", row.name},
                             {"endpoints", row.endpoints},
                             {"state", stateName(row)},
                             {"reason", reasonOf(row)}};
    if (row.report) {
      const auto& report = *row.report;
      component["version"] = report.version;
      component["uptime_s"] = report.uptime_s;
      component["peers"] = nlohmann::json::array();
      for (const auto& peer : report.peers) {
        component["peers"].push_back({{"name", peer.name},
                                      {"proxy", peer.proxy},
                                      {"connected", peer.link == PeerState::Link::kConnected},
                                      {"message", peer.reason},
                                      {"reconnections", peer.reconnections}});
      }
      component["rates"] = nlohmann::json::array();
      for (const auto& rate : report.rates) {
        component["rates"].push_back({{"name", rate.name}, {"hz", rate.hz}, {"total", rate.total}});
      }
      component["latencies"] = nlohmann::json::array();
      for (const auto& [name, figures] : report.latencies) {
        component["latencies"].push_back({{"name", name},
                                          {"samples", figures.samples},
                                          {"p50_ms", kMsPerSecond * figures.p50_s},
                                          {"p95_ms", kMsPerSecond * figures.p95_s},
                                          {"p99_ms", kMsPerSecond * figures.p99_s},
                                          {"max_ms", kMsPerSecond * figures.max_s}});
      }
      component["gauges"] = nlohmann::json::array();
      for (const auto& gauge : report.gauges) {
        component["gauges"].push_back(
            {{"name", gauge.name}, {"value", gauge.value}, {"sigma", gauge.sigma}, {"unit", gauge.unit}});
      }
      component["errors"] = nlohmann::json::array();
      for (const auto& error : report.errors) {
        component["errors"].push_back({{"stamp_us", error.stamp_us}, {"text", error.text}});
      }
    }
    components.push_back(std::move(component));
  }
  return {{"whole", isWhole(rows)}, {"components", std::move(components)}};
}

}  // namespace vismem
