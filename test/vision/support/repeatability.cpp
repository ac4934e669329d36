#include "vision/support/repeatability.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

#include "common/geometry/angles.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

constexpr double kNoise = 2.0;
constexpr double kGain = 0.85;
constexpr double kCornerShare = 0.08;
constexpr double kTurn_rad = degToRad(15.0);
constexpr double kMinimum_px = 10.0;
constexpr double kStructural_px = 5.0;
constexpr double kOrthogonal_px = 1.0;
constexpr double kLocated_px = 3.0;
constexpr double kOverlap = 0.5;
constexpr double kMaximumAngle_rad = degToRad(10.0);
/// Beyond the border of the picture the warp repeats its last pixels: edges there are not the picture's.
constexpr double kBorder_px = 3.0;

using Polygon = std::vector<Eigen::Vector2d>;

Eigen::Vector2d mapped(const Eigen::Matrix3d& H, const Eigen::Vector2d& p) {
  return (H * p.homogeneous()).hnormalized();
}

Polygon corners(const cv::Size& size, double border_px) {
  const double right = size.width - 1.0 - border_px;
  const double low = size.height - 1.0 - border_px;
  return {{border_px, border_px}, {right, border_px}, {right, low}, {border_px, low}};
}

/// Part of a segment inside a convex polygon whose corners run clockwise as a person sees the picture.
std::optional<Segment2> clipped(const Segment2& segment, const Polygon& polygon) {
  double low = 0.0;
  double high = 1.0;
  const Eigen::Vector2d d = segment.b - segment.a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d side = polygon[(i + 1) % polygon.size()] - polygon[i];
    const Eigen::Vector2d inwards(-side.y(), side.x());
    const double at_a = inwards.dot(segment.a - polygon[i]);
    const double slope = inwards.dot(d);
    if (slope == 0.0) {
      if (at_a < 0.0) return std::nullopt;
    } else if (slope > 0.0) {
      low = std::max(low, -at_a / slope);
    } else {
      high = std::min(high, -at_a / slope);
    }
  }
  if (low >= high) return std::nullopt;
  return Segment2{segment.a + low * d, segment.a + high * d};
}

double structuralDistance(const Segment2& x, const Segment2& y) {
  return 0.5 * std::min((x.a - y.a).norm() + (x.b - y.b).norm(), (x.a - y.b).norm() + (x.b - y.a).norm());
}

/// Infinite for a pair that does not belong together.
double orthogonalDistance(const Segment2& x, const Segment2& y) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (lineAngleDifference(x.direction(), y.direction()) > kMaximumAngle_rad) return kNone;
  const Segment2& longer = x.length() >= y.length() ? x : y;
  const Segment2& shorter = x.length() >= y.length() ? y : x;
  double first = projectionFraction(shorter.a, longer);
  double second = projectionFraction(shorter.b, longer);
  if (first > second) std::swap(first, second);
  const double common = std::min(second, 1.0) - std::max(first, 0.0);
  if (common < kOverlap * (second - first)) return kNone;
  return 0.25 *
         (distanceToLine(x.a, y) + distanceToLine(x.b, y) + distanceToLine(y.a, x) + distanceToLine(y.b, x));
}

void count(const std::vector<Segment2>& from, const std::vector<Segment2>& to, Repeatability& sum) {
  for (const Segment2& segment : from) {
    double structural = std::numeric_limits<double>::infinity();
    double orthogonal = structural;
    for (const Segment2& other : to) {
      // Beyond this nothing counts: spares the roots below.
      const double reach = 0.5 * ((segment.b - segment.a).lpNorm<1>() + (other.b - other.a).lpNorm<1>()) +
                           2.0 * kStructural_px;
      if ((segment.middle() - other.middle()).squaredNorm() > reach * reach) continue;
      structural = std::min(structural, structuralDistance(segment, other));
      orthogonal = std::min(orthogonal, orthogonalDistance(segment, other));
    }
    ++sum.segments;
    sum.structural += structural <= kStructural_px ? 1 : 0;
    sum.orthogonal += orthogonal <= kOrthogonal_px ? 1 : 0;
    if (orthogonal <= kLocated_px) {
      ++sum.located;
      sum.located_sum_px += orthogonal;
    }
  }
}

}  // namespace

TwoViews makeTwoViews(const cv::Mat& gray, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Eigen::Vector2d middle(0.5 * (gray.cols - 1), 0.5 * (gray.rows - 1));
  const double angle = uniform(-kTurn_rad, kTurn_rad);
  const double scale = uniform(0.85, 1.15);
  Eigen::Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const Eigen::Vector2d& corner : corners(gray.size(), 0.0)) {
    const Eigen::Vector2d moved = corner + Eigen::Vector2d(uniform(-kCornerShare, kCornerShare) * gray.cols,
                                                           uniform(-kCornerShare, kCornerShare) * gray.rows);
    const Eigen::Vector2d seen = middle + scale * (turn * (moved - middle));
    from.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
    to.emplace_back(static_cast<float>(seen.x()), static_cast<float>(seen.y()));
  }
  const cv::Mat H = cv::getPerspectiveTransform(from, to);
  TwoViews views;
  for (int i = 0; i < 9; ++i) views.H_b_a(i / 3, i % 3) = H.at<double>(i / 3, i % 3);
  views.a = gray.clone();
  cv::warpPerspective(gray, views.b, H, gray.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  views.b.convertTo(views.b, -1, kGain);
  addNoise(views.a, kNoise, random);
  addNoise(views.b, kNoise, random);
  return views;
}

void Repeatability::add(const Repeatability& other) {
  segments += other.segments;
  structural += other.structural;
  orthogonal += other.orthogonal;
  located += other.located;
  located_sum_px += other.located_sum_px;
}

Repeatability compareViews(const TwoViews& views, const std::vector<Segment2>& found_a,
                           const std::vector<Segment2>& found_b) {
  const Eigen::Matrix3d H_a_b = views.H_b_a.inverse();
  const Polygon view_a = corners(views.a.size(), kBorder_px);
  Polygon view_b = corners(views.b.size(), kBorder_px);
  for (Eigen::Vector2d& corner : view_b) corner = mapped(H_a_b, corner);
  const auto common = [&](const Segment2& segment) -> std::optional<Segment2> {
    auto inside = clipped(segment, view_a);
    if (inside) inside = clipped(*inside, view_b);
    return inside && inside->length() >= kMinimum_px ? inside : std::nullopt;
  };
  std::vector<Segment2> a;
  std::vector<Segment2> b;
  for (const Segment2& segment : found_a) {
    if (const auto inside = common(segment)) a.push_back(*inside);
  }
  for (const Segment2& segment : found_b) {
    if (const auto inside = common({mapped(H_a_b, segment.a), mapped(H_a_b, segment.b)}))
      b.push_back(*inside);
  }
  Repeatability sum;
  count(a, b, sum);
  count(b, a, sum);
  return sum;
}

}  // namespace vismem
