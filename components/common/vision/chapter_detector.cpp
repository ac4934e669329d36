// The Solis flow as the chapter's authors published it. See V1.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/vision/edge_sampling.h"
#include "common/vision/segment_detector.h"

namespace vismem {
namespace {

/// The published flow follows the border of a band beside the edge: sample both sides further out.
constexpr double kSideDistance_px = 3.0;
constexpr int kUndecided = -1;

/// Chords are classified into eight directions: along an axis up to a slope of one half, else diagonal. A
/// chord shorter than 2 px has none.
int directionClass(const cv::Point& chord) {
  const int across = std::abs(chord.x);
  const int down = std::abs(chord.y);
  if (std::max(across, down) < 2) return kUndecided;
  const int x = 2 * across <= down ? 0 : chord.x > 0 ? 1 : -1;
  const int y = 2 * down <= across ? 0 : chord.y > 0 ? 1 : -1;
  return 3 * (y + 1) + x + 1;
}

/// Chords first..last (inclusive) of one contour that share a direction.
struct Run {
  int direction = kUndecided;
  int first = 0;
  int last = 0;
  cv::Point begin;
  cv::Point end;
};

class ChapterDetector final : public SegmentDetector {
 public:
  explicit ChapterDetector(const ChapterSolisParams& params) : params_(params) {}

  void detect(const cv::Mat& image, std::vector<RawSegment>& out) override {
    out.clear();
    const cv::Mat gray = toGray(image);
    if (gray.cols < 16 || gray.rows < 16) return;
    cv::Mat work;
    cv::normalize(gray, work, 0, 255, cv::NORM_MINMAX);
    cv::blur(work, work, cv::Size(3, 3));
    cv::Mat laplacian;
    cv::Laplacian(work, laplacian, CV_16S, params_.laplace_kernel);
    cv::convertScaleAbs(laplacian, work);
    cv::threshold(work, work, params_.threshold, 255, cv::THRESH_BINARY);
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(work, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    for (const auto& contour : contours) {
      if (static_cast<int>(contour.size()) < params_.minimum_contour_px) continue;
      for (const Run& run : mergedRuns(contour)) append(gray, run, out);
    }
  }

 private:
  /// A fragment of another direction (or of none) ends a run and is dropped, as published.
  std::vector<Run> runs(const std::vector<cv::Point>& contour) const {
    std::vector<Run> found;
    Run run;
    const auto close = [&] {
      if (run.direction != kUndecided && run.last - run.first + 1 >= params_.minimum_fragments)
        found.push_back(run);
      run.direction = kUndecided;
    };
    // Chords do not share pixels: one of six pixels spans five steps of the contour.
    const int step = params_.chord_px;
    const int chords = static_cast<int>(contour.size()) / step;
    for (int i = 0; i < chords; ++i) {
      const cv::Point& begin = contour[static_cast<std::size_t>(i) * step];
      const cv::Point& end = contour[static_cast<std::size_t>(i + 1) * step - 1];
      const int direction = directionClass(end - begin);
      if (run.direction != kUndecided && direction == run.direction) {
        run.last = i;
        run.end = end;
      } else if (run.direction != kUndecided) {
        close();
      } else if (direction != kUndecided) {
        run = {direction, i, i, begin, end};
      }
    }
    close();
    return found;
  }

  std::vector<Run> mergedRuns(const std::vector<cv::Point>& contour) const {
    std::vector<Run> merged;
    for (const Run& run : runs(contour)) {
      if (!merged.empty()) {
        Run& last = merged.back();
        const bool near = cv::norm(run.begin - last.end) <= params_.merge_distance_px;
        if (run.direction == last.direction && run.first - last.last <= params_.merge_index_gap && near) {
          last.last = run.last;
          last.end = run.end;
          continue;
        }
      }
      merged.push_back(run);
    }
    return merged;
  }

  static void append(const cv::Mat& gray, const Run& run, std::vector<RawSegment>& out) {
    const Segment2 px{{run.begin.x, run.begin.y}, {run.end.x, run.end.y}};
    if (px.length() <= 0.0) return;
    const OrientedSegment oriented = orientByBrightness(gray, px, kSideDistance_px);
    out.push_back({oriented.px, oriented.strength});
  }

  ChapterSolisParams params_;
};

}  // namespace

std::unique_ptr<SegmentDetector> makeChapterDetector(const ChapterSolisParams& params) {
  return std::make_unique<ChapterDetector>(params);
}

}  // namespace vismem
