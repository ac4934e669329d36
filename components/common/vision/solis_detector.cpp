// The default detector: edge points, chains, runs of one direction fitted by total least squares (see V1).
#include <algorithm>
#include <cmath>

#include "common/vision/collinear_merge.h"
#include "common/vision/edge_points.h"
#include "common/vision/edge_sampling.h"
#include "common/vision/line_profile.h"
#include "common/vision/line_runs.h"
#include "common/vision/segment_detector.h"

namespace vismem {
namespace {

constexpr std::size_t kPixelsPerRun = 24;
constexpr std::size_t kMaximumReserved = 1U << 16;

constexpr double kSideDistance_px = 2.0;

/// Evidence for a gap: the brightness step in it is similar to that across both pieces.
class StepInGap final : public GapEvidence {
 public:
  StepInGap(const cv::Mat& image, double share) : image_(image), share_(share) {}
  bool goesOn(const Segment2& gap, const Segment2& before, const Segment2& after) const override {
    const double step = stepOf(gap);
    return step > 0.0 && step >= share_ * std::min(stepOf(before), stepOf(after));
  }

 private:
  double stepOf(const Segment2& px) const { return brightnessStep(image_, px, kSideDistance_px); }

  const cv::Mat& image_;
  double share_;
};

class SolisDetector final : public SegmentDetector {
 public:
  SolisDetector(const SolisParams& params, const EdgeRowKernel& kernel)
      : params_(params), kernel_(kernel), edges_(kernel), run_finder_(params, kernel), merger_(kernel) {}

  void detect(const cv::Mat& given, std::vector<RawSegment>& out) override {
    out.clear();
    checkPixelType(given);
    if (given.cols < 16 || given.rows < 16) return;
    const cv::Mat& image = grayOf(given);
    reserve(image.total());
    // Noise of the gradient, in the contrast of the step that would give it.
    const double noise = estimateNoise(image);
    const double noise_contrast = noise * noiseMagnitude() / stepMagnitude();
    edges_.find(image, std::max(params_.minimum_contrast, params_.noise_factor * noise_contrast),
                params_.bridge_missing_point);
    pieces_.clear();
    for (const LineRun& run : run_finder_.find(edges_)) {
      const Segment2 px{{run.ax_px, run.ay_px}, {run.bx_px, run.by_px}};
      pieces_.push_back({px, 0, run.points / px.length(), 0.0});
    }
    const CollinearMergeParams merge{params_.merge_angle_rad, params_.merge_offset_px, params_.merge_gap_px,
                                     params_.bridge_share, params_.bridge_px};
    const StepInGap evidence(image, params_.bridge_step_share);
    merger_.merge(pieces_, merge, &evidence);
    for (const GroupedSegment& piece : pieces_) {
      const double length = piece.px.length();
      if (length < params_.minimum_length_px) continue;
      const LineProfile profile = profileAcross(image, piece.px, noise);
      // The gradient along the edge defines the brighter side; the brightness beside a thin stripe may
      // differ.
      const double strength = std::abs(profile.step);
      if (length * length * strength < params_.minimum_significance) continue;
      if (strength * std::sqrt(length) < params_.minimum_certainty * noise) continue;
      const double shift_px =
          std::clamp(profile.aside_px, -params_.maximum_shift_px, params_.maximum_shift_px);
      const Eigen::Vector2d aside = shift_px * leftNormal(piece.px);
      out.push_back({{piece.px.a + aside, piece.px.b + aside}, strength});
    }
  }

 private:
  /// Reserves space for more runs than scenes have, so that later frames of a size allocate nothing.
  void reserve(std::size_t pixels) {
    if (pixels <= reserved_pixels_) return;
    reserved_pixels_ = pixels;
    const std::size_t count = std::clamp<std::size_t>(pixels / kPixelsPerRun, 64, kMaximumReserved);
    pieces_.reserve(count);
    merger_.reserve(count);
  }

  /// The brightness of a colour image, which is read many times.
  const cv::Mat& grayOf(const cv::Mat& image) {
    if (image.channels() == 1) return image;
    gray_.create(image.size(), CV_8UC1);
    for (int y = 0; y < image.rows; ++y) {
      kernel_.gray(image.ptr<std::uint8_t>(y), image.cols, gray_.ptr<std::uint8_t>(y));
    }
    return gray_;
  }

  SolisParams params_;
  const EdgeRowKernel& kernel_;
  cv::Mat gray_;
  std::size_t reserved_pixels_ = 0;
  EdgePointFinder edges_;
  LineRunFinder run_finder_;
  std::vector<GroupedSegment> pieces_;
  CollinearMerger merger_;
};

}  // namespace

std::unique_ptr<SegmentDetector> makeSolisDetector(const SolisParams& params) {
  return std::make_unique<SolisDetector>(params, bestEdgeRows());
}

}  // namespace vismem
