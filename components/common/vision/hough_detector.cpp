// Canny edges and the probabilistic Hough transform (see V2).
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/vision/edge_sampling.h"
#include "common/vision/segment_detector.h"

namespace vismem {
namespace {

constexpr double kSideDistance_px = 2.0;

class HoughDetector final : public SegmentDetector {
 public:
  explicit HoughDetector(const HoughParams& params) : params_(params) {}

  void detect(const cv::Mat& image, std::vector<RawSegment>& out) override {
    out.clear();
    const cv::Mat gray = toGray(image);
    if (gray.cols < 16 || gray.rows < 16) return;
    cv::Mat edges;
    // Isolated: for a part of a larger image, the smoothing must not read pixels around it.
    cv::GaussianBlur(gray, edges, cv::Size(5, 5), 0, 0, cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
    cv::Canny(edges, edges, params_.canny_low, params_.canny_high);
    // OpenCV seeds its own generator the same way in every call: the same image gives the same lines.
    std::vector<cv::Vec4i> lines;
    cv::HoughLinesP(edges, lines, 1.0, std::numbers::pi / 180.0, params_.votes, params_.minimum_length_px,
                    params_.maximum_gap_px);
    for (const cv::Vec4i& line : lines) {
      const Segment2 px{{line[0], line[1]}, {line[2], line[3]}};
      if (px.length() <= 0.0) continue;
      const OrientedSegment oriented = orientByBrightness(gray, px, kSideDistance_px);
      out.push_back({oriented.px, oriented.strength});
    }
  }

 private:
  HoughParams params_;
};

}  // namespace

std::unique_ptr<SegmentDetector> makeHoughDetector(const HoughParams& params) {
  return std::make_unique<HoughDetector>(params);
}

}  // namespace vismem
