#include "common/vision/colour_edges.h"

#include <algorithm>

#include "common/geometry/angles.h"
#include "common/vision/edge_rows.h"
#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr double kSameLine_px = 2.5;
constexpr double kSameDirection_rad = 0.12;
constexpr double kSideDistance_px = 2.0;
constexpr double kKnownShare = 0.7;   // covered by so much, an edge is known
constexpr double kWithinShare = 0.8;  // lying in another by so much, an edge is a piece of it

/// Length of the part of `base` that `other` lies beside, 0 when they are not one line [px].
double overlapOnLine(const Segment2& base, const Segment2& other) {
  const double length = base.length();
  const double ta = projectionFraction(other.a, base) * length;
  const double tb = projectionFraction(other.b, base) * length;
  const double low = std::max(0.0, std::min(ta, tb));
  const double high = std::min(length, std::max(ta, tb));
  if (high <= low) return 0.0;
  const Eigen::Vector2d between = base.a + 0.5 * (low + high) / length * (base.b - base.a);
  return distanceToLine(between, other) <= kSameLine_px ? high - low : 0.0;
}

}  // namespace

void strongestChannel(const cv::Mat& rgb, cv::Mat& plane) {
  plane.create(rgb.size(), CV_8UC1);
  for (int v = 0; v < rgb.rows; ++v) {
    bestEdgeRows().strongest(rgb.ptr<std::uint8_t>(v), rgb.cols, plane.ptr<std::uint8_t>(v));
  }
}

void ColourEdgeJoiner::join(const cv::Mat& image, const std::vector<RawSegment>& found_in_plane,
                            std::vector<RawSegment>& segments) {
  const std::size_t gray = segments.size();
  replaced_.assign(gray, false);
  directions_.clear();
  for (const RawSegment& segment : segments) directions_.push_back(segment.px_raw.direction());
  for (const RawSegment& found : found_in_plane) {
    const double direction = found.px_raw.direction();
    parallel_.clear();
    for (std::size_t i = 0; i < gray; ++i) {
      if (lineAngleDifference(direction, directions_[i]) <= kSameDirection_rad) parallel_.push_back(i);
    }
    double covered = 0.0;
    for (const std::size_t i : parallel_) covered += overlapOnLine(found.px_raw, segments[i].px_raw);
    if (covered >= kKnownShare * found.px_raw.length()) continue;
    for (const std::size_t i : parallel_) {
      const double length = segments[i].px_raw.length();
      if (overlapOnLine(segments[i].px_raw, found.px_raw) >= kWithinShare * length) replaced_[i] = true;
    }
    const OrientedSegment oriented = orientByBrightness(image, found.px_raw, kSideDistance_px);
    segments.push_back({oriented.px, oriented.strength});
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i < gray && replaced_[i]) continue;
    segments[kept++] = segments[i];
  }
  segments.resize(kept);
}

}  // namespace vismem
