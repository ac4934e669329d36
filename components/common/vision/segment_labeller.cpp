#include "common/vision/segment_labeller.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

constexpr std::size_t kMaximumDistances = 16;

/// Colour classes at the distances of one side.
struct Side {
  std::array<ColorClass, kMaximumDistances> classes{};
  std::size_t count = 0;

  /// The class of the nearest distance with one.
  ColorClass first() const {
    const auto* end = classes.data() + count;
    const auto* found = std::find_if(classes.data(), end, [](ColorClass c) { return c != kNoColorClass; });
    return found == end ? kNoColorClass : *found;
  }
};

/// Both sides, and the label of the nearest pair of distances that has a name, or kUnknownLabel.
struct Found {
  Side bright;
  Side dark;
  ColorClass bright_class = kNoColorClass;
  ColorClass dark_class = kNoColorClass;
  const Label* label = &kUnknownLabel;
};

/// Nearest pixel to a coordinate, or -1 outside.
int nearestPixel(double value, int size) {
  if (!(value > -0.5 && value < size - 0.5)) return -1;
  return std::min(static_cast<int>(value + 0.5), size - 1);
}

/// The majority class of the samples from `first` on, or kNoColorClass without a clear majority.
ColorClass classAlong(const cv::Mat& image, const Eigen::Vector2d& first, const Eigen::Vector2d& step,
                      const Palette& palette, const LabellerParams& params) {
  std::array<int, 256> votes;  // of those that the palette has; the rest is never touched
  const int classes = palette.classCount();
  std::fill_n(votes.begin(), classes + 1, 0);
  int inside = 0;
  for (int i = 0; i < params.samples; ++i) {
    const int x = nearestPixel(first.x() + i * step.x(), image.cols);
    const int y = nearestPixel(first.y() + i * step.y(), image.rows);
    if (x < 0 || y < 0) continue;
    const std::uint8_t* color = image.ptr<std::uint8_t>(y) + 3 * static_cast<std::ptrdiff_t>(x);
    ++votes[palette.classOf(color[0], color[1], color[2])];
    ++inside;
  }
  int most = 0;
  ColorClass best = kNoColorClass;
  for (int k = 1; k <= classes; ++k) {
    if (votes[k] > most) {
      most = votes[k];
      best = static_cast<ColorClass>(k);
    }
  }
  return inside == 0 || most < params.minimum_majority * inside ? kNoColorClass : best;
}

Side lookAside(const cv::Mat& image, const Segment2& px, const Eigen::Vector2d& outwards,
               const std::vector<double>& distances_px, const Palette& palette,
               const LabellerParams& params) {
  Side side;
  if (distances_px.size() > kMaximumDistances) {
    throw std::invalid_argument(std::to_string(distances_px.size()) +
                                " distances on a side of a segment (at most " +
                                std::to_string(kMaximumDistances) + ")");
  }
  const Eigen::Vector2d step = (1.0 - 2.0 * params.trim) / params.samples * (px.b - px.a);
  const Eigen::Vector2d first = px.a + params.trim * (px.b - px.a) + 0.5 * step;
  for (const double distance_px : distances_px) {
    side.classes[side.count++] = classAlong(image, first + distance_px * outwards, step, palette, params);
  }
  return side;
}

Found look(const cv::Mat& image, const Segment2& px, const Palette& palette, const LabellerParams& params) {
  Found found;
  if (image.type() != CV_8UC3 || !(px.length() > 0.0)) return found;
  const Eigen::Vector2d normal = leftNormal(px);
  found.bright = lookAside(image, px, normal, params.bright_distances_px, palette, params);
  found.dark = lookAside(image, px, -normal, params.dark_distances_px, palette, params);
  double nearest_px = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < found.bright.count; ++i) {
    for (std::size_t j = 0; j < found.dark.count; ++j) {
      const double distance_px = params.bright_distances_px[i] + params.dark_distances_px[j];
      if (distance_px >= nearest_px) continue;
      const Label& label = palette.label(found.bright.classes[i], found.dark.classes[j]);
      if (label == kUnknownLabel) continue;
      nearest_px = distance_px;
      found.bright_class = found.bright.classes[i];
      found.dark_class = found.dark.classes[j];
      found.label = &label;
    }
  }
  return found;
}

}  // namespace

const Label& segmentLabel(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                          const LabellerParams& params) {
  return *look(image, px_raw, palette, params).label;
}

SegmentSides labelSegment(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                          const LabellerParams& params) {
  const Found found = look(image, px_raw, palette, params);
  if (*found.label == kUnknownLabel) return {found.bright.first(), found.dark.first(), kUnknownLabel};
  return {found.bright_class, found.dark_class, *found.label};
}

}  // namespace vismem
