#include "active_visual_memory/core/line_gaps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace vismem {
namespace {

/// Bilinear mean of the channels; empty outside the image.
std::optional<double> greyAt(const cv::Mat& image, const Eigen::Vector2d& raw) {
  const int u = static_cast<int>(std::floor(raw.x()));
  const int v = static_cast<int>(std::floor(raw.y()));
  if (u < 0 || v < 0 || u + 1 >= image.cols || v + 1 >= image.rows) return std::nullopt;
  const int channels = image.channels();
  const double fu = raw.x() - u;
  const double fv = raw.y() - v;
  const unsigned char* top = image.ptr<unsigned char>(v) + u * channels;
  const unsigned char* bottom = image.ptr<unsigned char>(v + 1) + u * channels;
  double sum = 0.0;
  for (int c = 0; c < channels; ++c) {
    sum += (1.0 - fv) * ((1.0 - fu) * top[c] + fu * top[c + channels]) +
           fv * ((1.0 - fu) * bottom[c] + fu * bottom[c + channels]);
  }
  return sum / channels;
}

}  // namespace

std::vector<LineGap> findLineGaps(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                  const Segment2& px, const LineGapParams& params) {
  std::vector<LineGap> gaps;
  if (image.empty() || image.depth() != CV_8U) return gaps;
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  const Eigen::Vector2d aside = params.aside_px * Eigen::Vector2d(d.y(), -d.x());
  const int count = static_cast<int>(px.length());
  std::vector<double> contrast;
  contrast.reserve(static_cast<std::size_t>(std::max(0, count)));
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d at = px.a + (i + 0.5) * d;
    const auto left = greyAt(image, distortPixel(intrinsics, at + aside));
    const auto right = greyAt(image, distortPixel(intrinsics, at - aside));
    if (!left || !right) return gaps;
    contrast.push_back(*left - *right);
  }
  if (contrast.size() < 2 * params.least_edge_px + params.least_px) return gaps;
  std::vector<double> sorted = contrast;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double usual = sorted[sorted.size() / 2];
  if (std::abs(usual) < params.least_grey) return gaps;
  for (double& c : contrast) c /= usual;

  const auto isEdge = [&](std::size_t i) { return contrast[i] >= params.edge_share; };
  /// Between two samples, where the contrast passes the limit.
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

}  // namespace vismem
