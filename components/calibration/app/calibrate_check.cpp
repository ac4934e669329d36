#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "calibration/app/commands.h"
#include "calibration/core/body/daily_check.h"
#include "common/config/config_error.h"
#include "common/process/ice_setup.h"
#include "common/process/log.h"
#include "common/process/setup.h"
#include "common/process/status_client.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

struct CheckOptions {
  std::string setup;
  int port_offset = 0;
  double timeout_s = 2.0;
  DailyCheckParams params;
};

/// Estimates of the components of a setup that run.
std::vector<SelfEstimate> askEstimates(const CheckOptions& options) {
  const fs::path folder =
      fs::is_directory(options.setup) ? fs::path(options.setup) : fs::path("cfg") / options.setup;
  std::vector<std::string> names;
  std::vector<std::string> proxies;
  for (const SetupComponent& component : componentsOfSetup(folder)) {
    if (component.name != "active_visual_memory" && component.name != "localization") continue;
    const bool is_memory = component.name == "active_visual_memory";
    const std::string endpoints = !component.endpoints.empty() ? component.endpoints
                                  : is_memory                  ? "tcp -h 127.0.0.1 -p 9970"
                                                               : "tcp -h 127.0.0.1 -p 9971";
    names.push_back(component.name);
    proxies.push_back(component.name + "/component:" + shiftPorts(endpoints, options.port_offset));
  }
  if (proxies.empty()) throw ConfigError({folder.string() + ": has no active_visual_memory.cfg"});
  Logger log("calibrate", LogLevel::kError);
  const Ice::CommunicatorHolder ice(makeCommunicator(Properties{}, log));
  const auto answers = askStatus(*ice.communicator(), proxies,
                                 std::chrono::milliseconds(static_cast<int>(1e3 * options.timeout_s)));
  std::vector<SelfEstimate> estimates;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i].report) {
      std::cerr << names[i] << ": " << answers[i].failure << "\n";
      continue;
    }
    for (const auto& gauge : answers[i].report->gauges) {
      estimates.push_back({gauge.name, gauge.value, gauge.sigma, gauge.unit});
    }
  }
  if (estimates.empty()) {
    throw std::runtime_error("no component of " + folder.string() + " answered with an estimate of itself");
  }
  return estimates;
}

int check(const CheckOptions& options) {
  const DailyReport report = checkDaily(askEstimates(options), options.params);
  nlohmann::json json{{"checked", report.findings.size()}, {"good", report.isGood()}};
  for (const DailyFinding& finding : report.findings) {
    std::cout << finding.text << "\n";
    json["findings"].push_back({{"name", finding.name},
                                {"value", finding.value},
                                {"sigma", finding.sigma},
                                {"sigmas", finding.sigmas},
                                {"unit", finding.unit},
                                {"good", finding.is_good}});
  }
  if (report.findings.empty())
    throw std::runtime_error("nothing is estimated yet: let the robot drive a little");
  std::cout << json.dump() << std::endl;
  return report.isGood() ? 0 : 1;
}

}  // namespace

CalibrateCommand addCheckCommand(CLI::App& calibrate) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* app = calibrate.add_subcommand("check",
                                           "The daily check without a board: compares what the running "
                                           "memory and localization estimate of camera and "
                                           "wheels with the calibration. Exit code 1 if something is off by "
                                           "more than 3 standard deviations. The last "
                                           "line is JSON.");
  app->add_option("--setup", options->setup, "a folder of cfg/, or another folder")->required();
  app->add_option("--port-offset", options->port_offset, "added to the ports of the setup")
      ->check(CLI::Range(0, 50000));
  app->add_option("--camera-sigma-deg", options->params.camera_sigma_deg,
                  "standard deviation of the calibrated camera direction")
      ->check(CLI::Range(0.001, 5.0))
      ->capture_default_str();
  app->add_option("--wheels-sigma-percent", options->params.scale_sigma_percent,
                  "standard deviation of the calibrated wheels")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  app->add_option("--timeout", options->timeout_s, "how long an answer may take [s]")
      ->check(CLI::Range(0.05, 60.0))
      ->capture_default_str();
  return {app, [options] { return check(*options); }};
}

}  // namespace vismem
