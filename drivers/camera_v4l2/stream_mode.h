/// @file Selection of the camera mode nearest to a request. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/ports.h"
#include "drivers/camera_v4l2/pixel_format.h"

namespace vismem::v4l2 {

/// Period of the images as a fraction, as devices report it [s].
struct Interval {
  std::uint32_t numerator = 0;  ///< 0: unknown
  std::uint32_t denominator = 0;
  double rate_hz() const {
    return numerator == 0 ? 0.0 : static_cast<double>(denominator) / static_cast<double>(numerator);
  }
};

/// One format and size with its rates: single ones, an interval, or none if the camera does not report them.
struct Mode {
  PixelFormat format;
  int width = 0;
  int height = 0;
  std::vector<Interval> rates;
  std::optional<Interval> slowest;  ///< of a range, with `fastest`
  std::optional<Interval> fastest;
};

struct Choice {
  Mode mode;
  Interval interval;  ///< unknown (0) if the camera does not report its rates and none was requested
};

/// Size for a request without one.
constexpr int kUsualWidth_px = 640;
constexpr int kUsualHeight_px = 480;
constexpr double kUsualRate_hz = 30.0;

/// The nearest size; of its formats, the first of pixelFormats() that reaches the rate. Raw formats are
/// therefore preferred unless only compressed ones reach the rate.
/// @param modes not empty.
Choice chooseMode(const std::vector<Mode>& modes, const FrameRequest& request);

/// The side nearest to the request, for a camera with sizes in steps.
int nearestInSteps(int asked, int minimum, int maximum, int step);

/// The reply to a request: accepted, or adjusted with the actual values.
PortReply replyTo(const FrameRequest& request, int width, int height, double rate_hz);

}  // namespace vismem::v4l2
