// What TLS and the gateway cost: an RGB image over tcp, ssl and the operators' router, as ratios
// in one run; and many viewers of JPEG through the viewers' router while an operator drives. Real processes
// on loopback: simulator, gateway_access, both routers. Output: tables, and one line of JSON at the end.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/gateway/crowd_cost.h"
#include "bench/gateway/transport_cost.h"
#include "common/tool/command_line_tool.h"

namespace vismem {
namespace {

using nlohmann::json;

// Limits of --check.
constexpr double kMostSslRatio = 3.5;
constexpr double kMostGatewayRatio = 5.0;
constexpr double kMostRouterShare = 1.0;
constexpr double kMostOperatorP99_ms = 50.0;
/// Of the camera's rate, of the viewer with the fewest images.
constexpr double kLeastRateShare = 0.95;

struct Options {
  int width = 320;
  int viewers = 200;
  double rate_hz = 15.0;
  double seconds = 20.0;
  int rounds = 25;
  bool check = false;
};

double load() {
  double first = 0.0;
  std::ifstream("/proc/loadavg") >> first;
  return first;
}

/// Notes what is above (or below) its limit.
class Limits {
 public:
  void atMost(const std::string& what, double value, double limit) {
    if (value > limit) note(what, value, limit);
  }
  void atLeast(const std::string& what, double value, double limit) {
    if (value < limit) note(what, value, limit);
  }
  const std::vector<std::string>& missed() const { return missed_; }

 private:
  void note(const std::string& what, double value, double limit) {
    missed_.push_back(what + ": " + std::to_string(value) + " (limit " + std::to_string(limit) + ")");
  }
  std::vector<std::string> missed_;
};

json transports(const Site& site, const Options& options, Limits& limits) {
  site.pause(true);
  const auto costs = measureTransports(site, options.rounds);
  site.pause(false);
  std::printf("A call that returns %dx%d RGB; medians, processor time of client, robot and router:\n",
              options.width, options.width * 3 / 4);
  std::printf("  %-8s %9s %8s %14s %8s\n", "", "median us", "of tcp", "processor us", "of tcp");
  json result;
  for (const TransportCost& cost : costs) {
    std::printf("  %-8s %9.0f %8.2f %14.0f %8.2f\n", cost.name.c_str(), cost.median_us, cost.median_ratio,
                cost.processor_us, cost.processor_ratio);
    result[cost.name] = {{"median_us", cost.median_us},
                         {"median_ratio", cost.median_ratio},
                         {"processor_us", cost.processor_us},
                         {"processor_ratio", cost.processor_ratio}};
  }
  std::fflush(stdout);
  limits.atMost("ssl to tcp", costs[1].median_ratio, kMostSslRatio);
  limits.atMost("gateway to tcp", costs[2].median_ratio, kMostGatewayRatio);
  return result;
}

json show(const char* what, const CallTimes& times) {
  std::printf("  %-44s %7.2f %7.2f %7.2f\n", what, times.median_ms, times.p99_ms, times.most_ms);
  return {{"median_ms", times.median_ms}, {"p99_ms", times.p99_ms}, {"most_ms", times.most_ms}};
}

json crowd(const Site& site, const Options& options, Limits& limits) {
  const CrowdCost cost = measureCrowd(site, options.viewers, options.seconds);
  std::printf("%d viewers, JPEG of %.1f kB: %.2f images a second each, %.2f the slowest; a login %.1f ms\n",
              options.viewers, 1e-3 * cost.image_bytes, cost.rate_hz, cost.least_rate_hz, cost.login_ms);
  std::printf(
      "  cores: viewers' router %.2f, operators' router %.2f, robot %.2f, the viewers themselves %.2f\n",
      cost.router, cost.other_router, cost.robot, cost.viewers);
  std::printf("  %-44s %7s %7s %7s\n", "call every 20 ms [ms]", "p50", "p99", "max");
  json result = {{"viewers", options.viewers},
                 {"rate_hz", cost.rate_hz},
                 {"least_rate_hz", cost.least_rate_hz},
                 {"image_bytes", cost.image_bytes},
                 {"login_ms", cost.login_ms},
                 {"router_cores", cost.router},
                 {"operators_router_cores", cost.other_router},
                 {"robot_cores", cost.robot},
                 {"viewers_cores", cost.viewers}};
  result["operator_alone"] = show("operator drives, no viewers", cost.operator_alone);
  result["operator_beside"] = show("operator drives, beside the viewers", cost.operator_beside);
  result["viewer_beside"] = show("small call through the viewers' router", cost.viewer_beside);
  std::fflush(stdout);
  limits.atMost("cores of the viewers' router", cost.router, kMostRouterShare);
  limits.atMost("operator's p99 in ms", cost.operator_beside.p99_ms, kMostOperatorP99_ms);
  limits.atLeast("images a second of the slowest viewer", cost.least_rate_hz,
                 kLeastRateShare * options.rate_hz);
  return result;
}

int run(const Options& options) {
  json result = {{"benchmark", "gateway"}, {"load", load()}, {"width", options.width}};
  std::printf("Load of the machine before: %.1f\n", load());
  const Site site(options.width, options.rate_hz);
  Limits limits;
  result["transports"] = transports(site, options, limits);
  if (options.viewers > 0) result["crowd"] = crowd(site, options, limits);
  for (const std::string& one : limits.missed()) std::cout << "over its limit: " << one << "\n";
  result["missed"] = limits.missed();
  std::cout << result.dump() << std::endl;
  return options.check && !limits.missed().empty() ? 1 : 0;
}

}  // namespace
}  // namespace vismem

int main(int argc, char** argv) {
  CLI::App app("What TLS and the gateway cost, and how many viewers a router carries");
  vismem::Options options;
  app.add_option("--viewers", options.viewers, "sessions at the viewers' router; 0: none")
      ->check(CLI::Range(0, 2000));
  app.add_option("--width", options.width, "of images, which are 4:3 [px]")->check(CLI::Range(160, 1280));
  app.add_option("--rate", options.rate_hz, "of the camera [Hz]")->check(CLI::Range(1.0, 60.0));
  app.add_option("--seconds", options.seconds, "with viewers")->check(CLI::Range(1.0, 3600.0));
  app.add_option("--rounds", options.rounds, "of 20 calls over each transport")->check(CLI::Range(5, 10'000));
  app.add_flag("--check", options.check, "exit 1 when a figure misses its limit");
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    return vismem::run(options);
  } catch (const std::exception& error) {
    std::cerr << "gateway: " << error.what() << std::endl;
    return 1;
  }
}
