#include "common/vision/segment_labeller.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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
  std::vector<ColorClass> left;
  std::vector<ColorClass> right;
  for (const double distance_px : params.distances_px) {
    left.push_back(classBeside(image, px_raw, distance_px * normal, palette, params));
    right.push_back(classBeside(image, px_raw, -distance_px * normal, palette, params));
    // Only combinations with the distance just added are new.
    const std::size_t newest = left.size() - 1;
    for (std::size_t nearer = 0; nearer <= newest; ++nearer) {
      for (const auto& [l, r] : {std::pair{nearer, newest}, std::pair{newest, nearer}}) {
        const Label& label = palette.label(left[l], right[r]);
        if (label != kUnknownLabel) return {left[l], right[r], label};
      }
    }
  }
  const auto nearest = [](const std::vector<ColorClass>& classes) {
    const auto found =
        std::find_if(classes.begin(), classes.end(), [](ColorClass c) { return c != kNoColorClass; });
    return found == classes.end() ? kNoColorClass : *found;
  };
  sides.left = nearest(left);
  sides.right = nearest(right);
  return sides;
}

}  // namespace vismem
