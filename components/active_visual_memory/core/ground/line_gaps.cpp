#include "active_visual_memory/core/ground/line_gaps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

/// Bilinear; grey images have three equal channels. Empty outside the image.
std::optional<Eigen::Vector3d> colourAt(const cv::Mat& image, const Eigen::Vector2d& raw) {
  const int u = static_cast<int>(std::floor(raw.x()));
  const int v = static_cast<int>(std::floor(raw.y()));
  if (u < 0 || v < 0 || u + 1 >= image.cols || v + 1 >= image.rows) return std::nullopt;
  const int channels = image.channels();
  const double fu = raw.x() - u;
  const double fv = raw.y() - v;
  const unsigned char* top = image.ptr<unsigned char>(v) + u * channels;
  const unsigned char* bottom = image.ptr<unsigned char>(v + 1) + u * channels;
  Eigen::Vector3d colour;
  for (int i = 0; i < 3; ++i) {
    const int c = std::min(i, channels - 1);
    colour[i] = (1.0 - fv) * ((1.0 - fu) * top[c] + fu * top[c + channels]) +
                fv * ((1.0 - fu) * bottom[c] + fu * bottom[c + channels]);
  }
  return colour;
}

/// @param values are reordered.
double medianInPlace(std::span<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Colours across a line at one place of its edge.
struct LineProfile {
  Eigen::Vector3d floor = Eigen::Vector3d::Zero();  ///< beside it
  Eigen::Vector3d line =
      Eigen::Vector3d::Zero();  ///< its own colour: the sample that differs most from the floor
  Eigen::Vector3d beside = Eigen::Vector3d::Zero();  ///< integral from the edge to the floor [grey levels px]
};

/// @return empty if a sample lies outside the image.
std::optional<LineProfile> profileAt(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                     const Eigen::Vector2d& at, const Eigen::Vector2d& outward,
                                     const LineBumpParams& params) {
  constexpr double kStep_px = 0.5;
  const auto look = [&](double off_px) {
    return colourAt(image, distortPixel(intrinsics, at + off_px * outward));
  };
  LineProfile profile;
  for (double off = kStep_px; off <= params.reach_px; off += kStep_px) {
    const auto colour = look(off);
    if (!colour) return std::nullopt;
    profile.beside += kStep_px * *colour;
    profile.floor = *colour;
  }
  profile.line = profile.floor;
  for (double off = 0.0; off <= params.inside_px; off += kStep_px) {
    const auto colour = look(-off);
    if (!colour) return std::nullopt;
    if ((*colour - profile.floor).norm() > (profile.line - profile.floor).norm()) profile.line = *colour;
  }
  return profile;
}

/// @param values  workspace.
Eigen::Vector3d medianOf(std::span<const LineProfile> profiles, Eigen::Vector3d LineProfile::*colour,
                         std::pmr::vector<double>& values) {
  Eigen::Vector3d median;
  values.resize(profiles.size());
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < profiles.size(); ++i) values[i] = (profiles[i].*colour)[c];
    median[c] = medianInPlace(values);
  }
  return median;
}

}  // namespace

std::pmr::vector<LineGap> findLineGaps(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                       const Segment2& px, const LineGapParams& params,
                                       std::pmr::memory_resource* scratch) {
  std::pmr::vector<LineGap> gaps(scratch);
  if (image.empty() || image.depth() != CV_8U) return gaps;
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  const Eigen::Vector2d aside = params.aside_px * leftNormal(px);
  const int count = static_cast<int>(px.length());
  std::pmr::vector<double> contrast(scratch);
  contrast.reserve(static_cast<std::size_t>(std::max(0, count)));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d at = px.a + (i + 0.5) * d;
    const auto left = colourAt(image, distortPixel(intrinsics, at + aside));
    const auto right = colourAt(image, distortPixel(intrinsics, at - aside));
    if (!left || !right) return gaps;
    contrast.push_back(left->mean() - right->mean());
  }
  if (contrast.size() < 2 * params.least_edge_px + params.least_px) return gaps;
  std::pmr::vector<double> sorted(contrast, scratch);
  const double usual = medianInPlace(sorted);
  if (std::abs(usual) < params.least_grey) return gaps;
  for (double& c : contrast) c /= usual;

  const auto isEdge = [&](std::size_t i) { return contrast[i] >= params.edge_share; };
  /// Position between two samples where the contrast crosses the limit.
  const auto crossing = [&](std::size_t i) {
    return i + 0.5 + (params.edge_share - contrast[i]) / (contrast[i + 1] - contrast[i]);
  };
  std::size_t edge_since = 0;
  for (std::size_t i = 0; i < contrast.size(); ++i) {
    if (isEdge(i)) continue;
    std::size_t end = i;
    double least = contrast[i];
    while (end < contrast.size() && !isEdge(end)) least = std::min(least, contrast[end++]);
    std::size_t edge_to = end;
    while (edge_to < contrast.size() && isEdge(edge_to)) ++edge_to;
    const bool bounded = i >= edge_since + params.least_edge_px && edge_to >= end + params.least_edge_px;
    if (bounded && least < params.gap_share) {
      const LineGap gap{crossing(i - 1), crossing(end - 1)};
      if (gap.to_px - gap.from_px >= params.least_px) gaps.push_back(gap);
    }
    edge_since = end;
    i = edge_to - 1;
  }
  return gaps;
}

std::pmr::vector<LineGap> findLineBumps(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                        const Segment2& px, bool outward_left, const LineBumpParams& params,
                                        std::pmr::memory_resource* scratch) {
  std::pmr::vector<LineGap> bumps(scratch);
  if (image.empty() || image.depth() != CV_8U) return bumps;
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  const Eigen::Vector2d outward = (outward_left ? 1.0 : -1.0) * leftNormal(px);
  const int count = static_cast<int>(px.length());
  const int beside_px = params.beside_px;
  if (count < 2 * beside_px + params.least_px) return bumps;
  std::pmr::vector<LineProfile> profiles(scratch);
  profiles.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto profile = profileAt(image, intrinsics, px.a + (i + 0.5) * d, outward, params);
    if (!profile) return bumps;
    profiles.push_back(*profile);
  }
  std::pmr::vector<double> values(scratch);
  const Eigen::Vector3d floor = medianOf(profiles, &LineProfile::floor, values);
  const Eigen::Vector3d contrast = medianOf(profiles, &LineProfile::line, values) - floor;
  if (contrast.norm() < std::sqrt(3.0) * params.least_grey) return bumps;
  // Height of the line's colour beside the edge [px]; blur gives some all along it.
  std::pmr::vector<double> height(scratch);
  height.reserve(profiles.size());
  for (const LineProfile& profile : profiles) {
    height.push_back(contrast.dot(profile.beside - params.reach_px * floor) / contrast.squaredNorm());
  }
  values = height;
  const double least = medianInPlace(values) + params.least_height_px;
  for (int i = beside_px; i < count; ++i) {
    if (height[i] < least) continue;
    int top = i;
    int end = i;
    for (; end < count && height[end] >= least; ++end) {
      if (height[end] > height[top]) top = end;
    }
    if (end + beside_px > count) break;
    double around = 0.0;
    Eigen::Vector3d beside = Eigen::Vector3d::Zero();
    for (int k = 0; k < beside_px; ++k) {
      around += (height[i - 1 - k] + height[end + k]) / (2.0 * beside_px);
      beside += (profiles[i - 1 - k].beside + profiles[end + k].beside) / (2.0 * beside_px);
    }
    i = end;
    const Eigen::Vector3d more = profiles[top].beside - beside;
    const bool of_line = contrast.dot(more) >= params.same_colour * contrast.norm() * more.norm();
    if (!of_line || height[top] - around < params.least_height_px) continue;
    // Its ends are at half height.
    const double half = 0.5 * (height[top] + around);
    int first = top;
    while (first > 0 && height[first] >= half) --first;
    int last = top;
    while (last + 1 < count && height[last] >= half) ++last;
    if (height[first] >= half || height[last] >= half) continue;
    const auto passing = [&](int low, int high) {
      return low + 0.5 + (high - low) * (half - height[low]) / (height[high] - height[low]);
    };
    const LineGap bump{passing(first, first + 1), passing(last, last - 1)};
    const double length = bump.to_px - bump.from_px;
    if (length >= params.least_px && length <= params.most_px) bumps.push_back(bump);
  }
  return bumps;
}

}  // namespace vismem
