#include "calibration/core/body/daily_check.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>

namespace vismem {
namespace {

std::optional<double> calibratedSigma(const std::string& name, const DailyCheckParams& params) {
  if (name == "camera knock") return params.camera_sigma_deg;
  if (name == "odometry yaw bias") return params.yaw_bias_sigma_degpm;
  if (name == "odometry yaw scale error" || name == "odometry distance scale error") {
    return params.scale_sigma_percent;
  }
  return std::nullopt;
}

std::string describe(const DailyFinding& f) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  if (f.is_good) {
    text << f.name << ": " << f.value << " +- " << f.sigma << " " << f.unit << ", as calibrated";
  } else if (f.name == "camera knock") {
    text << "the camera was knocked by " << std::setprecision(1) << std::abs(f.value) << " degrees ("
         << f.sigmas << " standard deviations): run calibrate body";
  } else {
    text << f.name << ": " << f.value << " +- " << f.sigma << " " << f.unit << " (" << std::setprecision(1)
         << f.sigmas << " standard deviations off the calibration): run calibrate body, or pump up the tyres";
  }
  return text.str();
}

}  // namespace

bool DailyReport::isGood() const {
  return std::all_of(findings.begin(), findings.end(), [](const auto& f) { return f.is_good; });
}

DailyReport checkDaily(const std::vector<SelfEstimate>& estimates, const DailyCheckParams& params) {
  DailyReport report;
  for (const SelfEstimate& estimate : estimates) {
    const auto calibrated = calibratedSigma(estimate.name, params);
    if (!calibrated) continue;
    DailyFinding f{
        estimate.name, estimate.value, std::hypot(estimate.sigma, *calibrated), 0.0, estimate.unit, true, ""};
    f.sigmas = std::abs(f.value) / f.sigma;
    f.is_good = f.sigmas <= params.alarm_sigmas;
    f.text = describe(f);
    report.findings.push_back(f);
  }
  return report;
}

}  // namespace vismem
