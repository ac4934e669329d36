/// @file The daily check without a board: what a running robot estimates of itself against its calibration.
/// Pure. See B5.
#pragma once

#include <string>
#include <vector>

namespace vismem {

/// A quantity that a component estimates of itself, as its status has it.
struct SelfEstimate {
  std::string name;
  double value = 0.0;
  double sigma = 0.0;
  std::string unit;
};

/// Standard deviations of the calibration itself.
struct DailyCheckParams {
  double camera_sigma_deg = 0.05;
  double scale_sigma_percent = 0.2;    ///< of odometry's distance and yaw
  double yaw_bias_sigma_degpm = 0.05;  ///< of odometry's yaw per metre
  double alarm_sigmas = 3.0;
};

struct DailyFinding {
  std::string name;
  double value = 0.0;
  double sigma = 0.0;  ///< of estimate and calibration together
  double sigmas = 0.0;
  std::string unit;
  bool is_good = true;
  std::string text;  ///< for people
};

struct DailyReport {
  std::vector<DailyFinding> findings;
  bool isGood() const;
};

/// Looks at "camera knock" and the odometry's errors; other estimates are left out.
DailyReport checkDaily(const std::vector<SelfEstimate>& estimates, const DailyCheckParams& params);

}  // namespace vismem
