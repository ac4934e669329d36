#include "common/vision/gap_split.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

/// Value of a sample outside the image.
constexpr int kNothing = std::numeric_limits<int>::min();

int brightnessAt(const cv::Mat& image, const Eigen::Vector2d& px) {
  const auto column = static_cast<int>(std::lround(px.x()));
  const auto row = static_cast<int>(std::lround(px.y()));
  if (column < 0 || row < 0 || column >= image.cols || row >= image.rows) return kNothing;
  return brightness(image.ptr<std::uint8_t>(row), column, image.channels());
}

/// The larger of the steps 1 and 2 px beside: of a line of a pixel the near one shows most.
int stepAt(const cv::Mat& image, const Eigen::Vector2d& px, const Eigen::Vector2d& left) {
  int step = kNothing;
  for (const double distance : {1.0, 2.0}) {
    const int l = brightnessAt(image, px + distance * left);
    const int r = brightnessAt(image, px - distance * left);
    if (l != kNothing && r != kNothing) step = std::max(step, l - r);
  }
  return step;
}

}  // namespace

void GapSplitter::split(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                        std::vector<ImageSegment>& segments, const GapSplitParams& params) {
  pieces_.clear();
  for (const ImageSegment& segment : segments) {
    const double length = segment.px.length();
    const int count = static_cast<int>(length);
    if (segment.strength < params.least_step || length < params.minimum_px + params.min_gap_px) {
      pieces_.push_back(segment);
      continue;
    }
    const Eigen::Vector2d d = segment.px.b - segment.px.a;
    const Eigen::Vector2d left = leftNormal(segment.px);
    steps_.clear();
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d ideal = segment.px.a + (i + 0.5) / count * d;
      steps_.push_back(
          stepAt(image, intrinsics.hasDistortion() ? distortPixel(intrinsics, ideal) : ideal, left));
    }
    sorted_ = steps_;
    std::nth_element(sorted_.begin(), sorted_.begin() + count / 2, sorted_.end());
    const int usual = sorted_[static_cast<std::size_t>(count / 2)];
    if (usual < params.least_step) {
      pieces_.push_back(segment);
      continue;
    }
    const double flat = params.flat_share * usual;
    int from = 0;
    const auto piece = [&](int to) {
      if (to - from < params.minimum_px && to - from < count) return;
      ImageSegment part = segment;
      if (from > 0) part.px.a = segment.px.a + static_cast<double>(from) / count * d;
      if (to < count) part.px.b = segment.px.a + static_cast<double>(to) / count * d;
      pieces_.push_back(std::move(part));
    };
    for (int i = 0; i < count;) {
      int end = i;
      while (end < count && steps_[static_cast<std::size_t>(end)] != kNothing &&
             steps_[static_cast<std::size_t>(end)] < flat) {
        ++end;
      }
      // Gaps at the ends are ignored: the detector locates the ends more precisely.
      if (i > 0 && end < count && end - i >= params.min_gap_px) {
        piece(i);
        from = end;
      }
      i = std::max(end, i + 1);
    }
    piece(count);
  }
  segments.swap(pieces_);
}

}  // namespace vismem
