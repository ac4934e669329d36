#include "common/robot/command_limits.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/config/text_format.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// A value with few digits, enough to distinguish it from the limit.
std::string text(double value) {
  return formatted("%.4g", value);
}

/// Collects the problems and the changes of a command.
class Check {
 public:
  /// @return the value, clamped to [low, high].
  /// @param scale to the unit of the message.
  double within(const char* name, double value, double low, double high, double scale, const char* unit) {
    if (!std::isfinite(value)) {
      add(rejections_, std::string(name) + " = " + text(value) + " (must be finite)");
      return 0.0;
    }
    const double limited = std::clamp(value, low, high);
    if (limited != value) {
      add(changes_,
          std::string(name) + " " + text(value * scale) + " " + unit + " to " + text(limited * scale));
    }
    return limited;
  }
  /// @return the maximum rate on the way to a position: 0 and higher values mean the maximum.
  double bound(const char* name, double value, double maximum) {
    if (!(std::isfinite(value) && value >= 0.0)) {
      add(rejections_, std::string(name) + " = " + text(value) + " (must be finite and >= 0)");
      return 0.0;
    }
    return value == 0.0 ? maximum : std::min(value, maximum);
  }

  PortReply reply() const {
    if (!rejections_.empty()) return PortReply::rejected(rejections_);
    return changes_.empty() ? PortReply::accepted() : PortReply::adjusted(changes_ + " (the limit)");
  }

 private:
  static void add(std::string& list, const std::string& item) { list += (list.empty() ? "" : ", ") + item; }

  std::string rejections_;
  std::string changes_;
};

const double kDeg = radToDeg(1.0);

}  // namespace

LimitedPanTiltCommand limitCommand(const PanTiltLimits& l, const PanTiltCommand& asked) {
  Check check;
  PanTiltCommand c = asked;
  if (asked.kind == PanTiltCommand::Kind::kPosition) {
    c.pan_rad = check.within("pan", asked.pan_rad, l.min_pan_rad, l.max_pan_rad, kDeg, "deg");
    c.tilt_rad = check.within("tilt", asked.tilt_rad, l.min_tilt_rad, l.max_tilt_rad, kDeg, "deg");
    c.pan_rate_radps = check.bound("bound of the pan rate", asked.pan_rate_radps, l.max_pan_rate_radps);
    c.tilt_rate_radps = check.bound("bound of the tilt rate", asked.tilt_rate_radps, l.max_tilt_rate_radps);
  } else {
    const auto rate = [&check](const char* name, double value, double maximum) {
      return check.within(name, value, -maximum, maximum, kDeg, "deg/s");
    };
    c.pan_rad = c.tilt_rad = 0.0;
    c.pan_rate_radps = rate("pan rate", asked.pan_rate_radps, l.max_pan_rate_radps);
    c.tilt_rate_radps = rate("tilt rate", asked.tilt_rate_radps, l.max_tilt_rate_radps);
  }
  return {c, check.reply()};
}

LimitedVelocity limitVelocity(const BaseLimits& l, double v_mps, double w_radps) {
  Check check;
  const double v = check.within("speed", v_mps, -l.max_speed_mps, l.max_speed_mps, 1.0, "m/s");
  const double w =
      check.within("turn rate", w_radps, -l.max_turn_rate_radps, l.max_turn_rate_radps, kDeg, "deg/s");
  return {v, w, check.reply()};
}

}  // namespace vismem
