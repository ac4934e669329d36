/// @file Which of the modes that a camera offers comes nearest to what is asked. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/ports.h"
#include "drivers/camera_v4l2/pixel_format.h"

namespace vismem::v4l2 {

/// Seconds from picture to picture as a fraction, which is how devices have it.
struct Interval {
  std::uint32_t numerator = 0;  ///< 0: unknown
  std::uint32_t denominator = 0;
  double rate_hz() const {
    return numerator == 0 ? 0.0 : static_cast<double>(denominator) / static_cast<double>(numerator);
  }
};

/// One format and size with its rates: single ones, all between two, or neither if the camera does not tell.
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
  Interval interval;  ///< unknown (0) if the camera does not tell its rates and none was asked for
};

/// Taken where a request leaves it open.
constexpr int kUsualWidth_px = 640;
constexpr int kUsualHeight_px = 480;
constexpr double kUsualRate_hz = 30.0;

/// The nearest size; of formats that have it, one that reaches the rate, the first of pixelFormats(). So
/// raw pictures are taken unless only compressed ones come fast enough.
/// @param modes not empty.
Choice chooseMode(const std::vector<Mode>& modes, const FrameRequest& request);

/// One side of a size that a camera offers in steps, nearest to what is asked.
int nearestInSteps(int asked, int minimum, int maximum, int step);

/// What became of a request: accepted, or adjusted with what it is instead.
PortReply replyTo(const FrameRequest& request, int width, int height, double rate_hz);

}  // namespace vismem::v4l2
