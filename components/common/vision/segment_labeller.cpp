#include "common/vision/segment_labeller.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

/// The class that most samples beside the segment have, or kNoColorClass without a clear majority.
ColorClass classBeside(const cv::Mat& image, const Segment2& px, const Eigen::Vector2d& aside,
                       const Palette& palette, const LabellerParams& params) {
  std::array<int, 256> votes{};
  int inside = 0;
  for (int i = 0; i < params.samples; ++i) {
    const double t = params.trim + (1.0 - 2.0 * params.trim) * (i + 0.5) / params.samples;
    const Eigen::Vector2d p = px.a + t * (px.b - px.a) + aside;
    const int x = static_cast<int>(std::lround(p.x()));
    const int y = static_cast<int>(std::lround(p.y()));
    if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) continue;
    const auto& color = image.at<cv::Vec3b>(y, x);
    ++votes[palette.classOf(color[0], color[1], color[2])];
    ++inside;
  }
  const auto most = std::max_element(votes.begin() + 1, votes.end());
  if (inside == 0 || *most < params.minimum_majority * inside) return kNoColorClass;
  return static_cast<ColorClass>(most - votes.begin());
}

}  // namespace

SegmentSides labelSegment(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                          const LabellerParams& params) {
  SegmentSides sides;
  if (image.type() != CV_8UC3 || !(px_raw.length() > 0.0)) return sides;
  const Eigen::Vector2d normal = leftNormal(px_raw);
  const auto classesAt = [&](const std::vector<double>& distances_px, double sign) {
    std::vector<ColorClass> classes;
    for (const double distance_px : distances_px) {
      classes.push_back(classBeside(image, px_raw, sign * distance_px * normal, palette, params));
    }
    return classes;
  };
  const auto bright = classesAt(params.bright_distances_px, 1.0);
  const auto dark = classesAt(params.dark_distances_px, -1.0);
  double nearest_px = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < bright.size(); ++i) {
    for (std::size_t j = 0; j < dark.size(); ++j) {
      const double distance_px = params.bright_distances_px[i] + params.dark_distances_px[j];
      const Label& label = palette.label(bright[i], dark[j]);
      if (label == kUnknownLabel || distance_px >= nearest_px) continue;
      nearest_px = distance_px;
      sides = {bright[i], dark[j], label};
    }
  }
  if (sides.label != kUnknownLabel) return sides;
  const auto first = [](const std::vector<ColorClass>& classes) {
    const auto found =
        std::find_if(classes.begin(), classes.end(), [](ColorClass c) { return c != kNoColorClass; });
    return found == classes.end() ? kNoColorClass : *found;
  };
  sides.bright = first(bright);
  sides.dark = first(dark);
  return sides;
}

}  // namespace vismem
