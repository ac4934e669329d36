#include "common/vision/line_profile.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr int kAcross = 8;            // pixels side by side that are read at a place
constexpr int kBefore = 3;            // number of them before the segment
constexpr int kPhases = 4;            // quarters of a pixel: sums are kept for each, and interpolated once
constexpr int kMaximumPlaces = 128;   // along the segment; 16 bits hold the sums of 257
constexpr double kOne = 65536.0;      // fixed point with 16 bits of fraction
constexpr double kSide_px = 2.0;      // where the step is measured
constexpr double kExpected_px = 0.2;  // deviation of `aside_px` from 0 without noise

/// Pixels side by side, the first one in the lowest byte: in a register.
using Pixels = std::uint64_t;
static_assert(sizeof(Pixels) == kAcross);

using Bytes = std::uint8_t __attribute__((vector_size(kAcross)));
using Sums = std::uint16_t __attribute__((vector_size(2 * kAcross)));

Pixels pixelAt(int k, std::uint8_t value) {
  return static_cast<Pixels>(value) << (8 * k);
}

/// Sums of pixels by the phase of the place where the segment crosses them.
struct PhaseSums {
  Sums sum[kPhases] = {};
  std::int64_t residual = 0;  // of the places: what their phases leave out [1/65536 px]
  int places = 0;
};

/// Adds places begin..end-1 along the major axis. `read(along, first)` gives the pixels across from `first`
/// on.
template <typename Read>
PhaseSums sumUp(double at_begin, double slope, int begin, int end, const Read& read) {
  PhaseSums sums;
  const int stride = 1 + (end - begin - 1) / kMaximumPlaces;
  constexpr int kPhaseBits = 14;
  constexpr std::int64_t kPhase = 1 << kPhaseBits;
  static_assert(kPhase * kPhases == 65536);
  auto across = static_cast<std::int64_t>(at_begin * kOne) + kPhase / 2;
  const auto step = static_cast<std::int64_t>(slope * stride * kOne);
  for (int along = begin; along < end; along += stride, across += step) {
    const Pixels pixels = read(along, static_cast<int>(across >> 16) - kBefore);
    Bytes bytes;
    std::memcpy(&bytes, &pixels, sizeof(bytes));
    sums.sum[across >> kPhaseBits & (kPhases - 1)] += __builtin_convertvector(bytes, Sums);
    sums.residual += (across & (kPhase - 1)) - kPhase / 2;
    ++sums.places;
  }
  return sums;
}

PhaseSums sumsAcross(const cv::Mat& image, const Segment2& px, bool steep) {
  const int channels = image.channels();
  const Eigen::Vector2d d = px.b - px.a;
  const int major = steep ? 1 : 0;
  const int length = steep ? image.rows : image.cols;
  const int width = steep ? image.cols : image.rows;
  const int begin = std::max(0, static_cast<int>(std::ceil(std::min(px.a[major], px.b[major]))));
  const int end = std::min(length - 1, static_cast<int>(std::floor(std::max(px.a[major], px.b[major])))) + 1;
  const double slope = d[1 - major] / d[major];
  const double at_begin = px.a[1 - major] + slope * (begin - px.a[major]);
  const auto slowly = [&](int along, int first) {
    Pixels out = 0;
    for (int k = 0; k < kAcross; ++k) {
      const int across = std::clamp(first + k, 0, width - 1);
      const int x = steep ? across : along;
      const int y = steep ? along : across;
      out |= pixelAt(k, static_cast<std::uint8_t>(brightness(image.ptr<std::uint8_t>(y), x, channels)));
    }
    return out;
  };
  const auto inside = [&](int first) { return first >= 0 && first + kAcross <= width; };
  if (channels != 1) return sumUp(at_begin, slope, begin, end, slowly);
  if (steep) {
    return sumUp(at_begin, slope, begin, end, [&](int along, int first) {
      if (!inside(first)) return slowly(along, first);
      Pixels out;
      std::memcpy(&out, image.ptr<std::uint8_t>(along) + first, kAcross);
      return out;
    });
  }
  const std::size_t row = image.step;
  return sumUp(at_begin, slope, begin, end, [&](int along, int first) {
    if (!inside(first)) return slowly(along, first);
    const std::uint8_t* pixel = image.ptr<std::uint8_t>(first) + along;
    Pixels out = 0;
    for (int k = 0; k < kAcross; ++k) out |= pixelAt(k, pixel[k * row]);
    return out;
  });
}

/// Sums of brightness every half pixel, from -kBefore px on, times kPhases: linear between pixels.
struct HalfSums {
  std::int32_t whole[kAcross];  // the last of each means nothing
  std::int32_t half[kAcross];
};

HalfSums interpolate(const PhaseSums& sums) {
  static_assert(kPhases == 4);
  std::uint16_t padded[kPhases][kAcross + 2] = {};
  for (int phase = 0; phase < kPhases; ++phase) std::memcpy(padded[phase], &sums.sum[phase], sizeof(Sums));
  const auto& [s0, s1, s2, s3] = padded;
  HalfSums out;
  for (int k = 0; k < kAcross; ++k) {
    out.whole[k] = 4 * s0[k] + 3 * s1[k] + s1[k + 1] + 2 * (s2[k] + s2[k + 1]) + s3[k] + 3 * s3[k + 1];
    out.half[k] = 2 * (s0[k] + s0[k + 1]) + s1[k] + 3 * s1[k + 1] + 4 * s2[k + 1] + 3 * s3[k + 1] + s3[k + 2];
  }
  return out;
}

}  // namespace

LineProfile profileAcross(const cv::Mat& image, const Segment2& px, double noise) {
  const Eigen::Vector2d d = px.b - px.a;
  const bool steep = std::abs(d.y()) >= std::abs(d.x());
  const PhaseSums sums = sumsAcross(image, px, steep);
  if (sums.places == 0) return {};
  const HalfSums profile = interpolate(sums);
  const double scale = 1.0 / (kPhases * sums.places);
  // The sums are along an axis: its component across the segment, positive to the left.
  const Eigen::Vector2d left = leftNormal(px);
  const double way = steep ? left.x() : left.y();
  const double sign = way < 0.0 ? -1.0 : 1.0;
  LineProfile out;
  const auto at = [&](int halves) {
    const int from_first = halves + 2 * kBefore;
    return static_cast<double>((from_first % 2 == 0 ? profile.whole : profile.half)[from_first / 2]);
  };
  const double side = 2.0 * kSide_px / std::abs(way);  // in halves of a pixel, under 6
  const int whole = static_cast<int>(side);
  const auto stepAt = [&](int halves) { return sign * scale * (at(halves) - at(-halves)); };
  out.step = stepAt(whole) + (side - whole) * (stepAt(std::min(whole + 1, 2 * kBefore)) - stepAt(whole));
  // Rises from half a pixel before to half a pixel after places half a pixel apart. The edge is the hill of
  // them that is highest within a pixel of the segment, down to the valleys beside it, where another edge
  // begins.
  constexpr int kReach = 4;  // halves of a pixel
  constexpr int kRises = 2 * kReach + 1;
  double rise[kRises];
  for (int k = 0; k < kRises; ++k) rise[k] = sign * scale * (at(k - kReach + 1) - at(k - kReach - 1));
  int best = kReach - 2;
  for (int k = kReach - 1; k <= kReach + 2; ++k) best = rise[k] > rise[best] ? k : best;
  if (rise[best] <= 0.0) return out;
  int first = best;
  int last = best;
  while (first > 0 && rise[first - 1] > 0.0 && rise[first - 1] <= rise[first]) --first;
  while (last + 1 < kRises && rise[last + 1] > 0.0 && rise[last + 1] <= rise[last]) ++last;
  double height = 0.0;
  double moment = 0.0;
  for (int k = first; k <= last; ++k) {
    height += rise[k];
    moment += rise[k] * (k - kReach);
  }
  const double middle = 0.5 * moment / height;
  const double residual = static_cast<double>(sums.residual) / (kOne * sums.places);
  // Half of the height is the step: rises overlap by half. The moment is a sum of brightness over the hill's
  // width.
  const double deviation = 2.0 * noise / height;
  const double variance = 0.5 * (last - first + 1) * deviation * deviation / sums.places;
  const double trust = kExpected_px * kExpected_px / (kExpected_px * kExpected_px + variance);
  out.aside_px = trust * (middle - residual) * way;
  return out;
}

}  // namespace vismem
