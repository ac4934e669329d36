#include "drivers/camera_v4l2/stream_mode.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <tuple>

namespace vismem::v4l2 {
namespace {

constexpr double kSameRate_hz = 1e-6;

/// Distance of two sizes, as a ratio.
double distance(double is, double asked) {
  return asked > 0.0 ? std::abs(std::log(is / asked)) : 0.0;
}

Interval intervalOf(double rate_hz) {
  constexpr std::uint32_t kParts = 1000;
  return {kParts, static_cast<std::uint32_t>(std::lround(kParts * rate_hz))};
}

Interval nearestInterval(const Mode& mode, double asked_hz) {
  if (mode.slowest && mode.fastest) {
    if (asked_hz <= mode.slowest->rate_hz()) return *mode.slowest;
    if (asked_hz >= mode.fastest->rate_hz()) return *mode.fastest;
    return intervalOf(asked_hz);
  }
  if (mode.rates.empty()) return {};
  return *std::min_element(mode.rates.begin(), mode.rates.end(), [&](const Interval& a, const Interval& b) {
    return std::abs(a.rate_hz() - asked_hz) < std::abs(b.rate_hz() - asked_hz);
  });
}

}  // namespace

Choice chooseMode(const std::vector<Mode>& modes, const FrameRequest& request) {
  const bool open_size = request.width == 0 && request.height == 0;
  const int width = open_size ? kUsualWidth_px : request.width;
  const int height = open_size ? kUsualHeight_px : request.height;
  const double rate_hz = request.rate_hz > 0.0 ? request.rate_hz : kUsualRate_hz;
  const auto rank = [](const PixelFormat& format) {
    const auto formats = pixelFormats();
    return std::find_if(formats.begin(), formats.end(),
                        [&](const PixelFormat& f) { return f.fourcc == format.fourcc; }) -
           formats.begin();
  };
  const auto cost = [&](const Mode& mode) {
    // With one side free, the aspect ratio is the camera's usual one.
    const double shape = width == 0 || height == 0 ? distance(mode.width * 3.0, mode.height * 4.0) : 0.0;
    const double size = distance(mode.width, width) + distance(mode.height, height);
    const Interval interval = nearestInterval(mode, rate_hz);
    // A camera that does not report its rates is assumed to reach them.
    const double slow =
        interval.numerator == 0 ? 0.0 : std::max(0.0, rate_hz - interval.rate_hz() - kSameRate_hz);
    const double fast =
        interval.numerator == 0 ? 0.0 : std::max(0.0, interval.rate_hz() - rate_hz - kSameRate_hz);
    return std::tuple(size, shape, request.rate_hz > 0.0 ? slow + fast : slow, rank(mode.format));
  };
  const Mode& best = *std::min_element(modes.begin(), modes.end(),
                                       [&](const Mode& a, const Mode& b) { return cost(a) < cost(b); });
  Interval interval = nearestInterval(best, rate_hz);
  if (interval.numerator == 0 && request.rate_hz > 0.0) interval = intervalOf(request.rate_hz);
  return {best, interval};
}

int nearestInSteps(int asked, int minimum, int maximum, int step) {
  const int inside = std::clamp(asked, minimum, std::max(minimum, maximum));
  if (step < 1) return inside;
  const int steps = (inside - minimum + step / 2) / step;
  return std::min(minimum + steps * step, minimum + (std::max(minimum, maximum) - minimum) / step * step);
}

PortReply replyTo(const FrameRequest& request, int width, int height, double rate_hz) {
  std::ostringstream text;
  if ((request.width > 0 && request.width != width) || (request.height > 0 && request.height != height)) {
    text << width << "x" << height << ", the nearest that the camera offers";
  }
  if (request.rate_hz > 0.0 && !(std::abs(request.rate_hz - rate_hz) < kSameRate_hz)) {
    text << (text.tellp() > 0 ? "; " : "");
    if (rate_hz > 0.0) {
      text << rate_hz << " Hz, the nearest that the camera offers";
    } else {
      text << "the rate is the camera's own";
    }
  }
  return text.str().empty() ? PortReply::accepted() : PortReply::adjusted(text.str());
}

}  // namespace vismem::v4l2
