#include "bench/vision/detectors.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_drawing.hpp>
#include <opencv2/ximgproc/fast_line_detector.hpp>

#include "common/vision/segment_detector.h"

namespace vismem {
namespace {

class Own final : public MeasuredDetector {
 public:
  explicit Own(const std::string& name) : detector_(makeSegmentDetector(name)) {}
  void run(const cv::Mat& gray) override { detector_->detect(gray, found_); }
  std::vector<Segment2> segments() const override {
    std::vector<Segment2> out;
    for (const RawSegment& segment : found_) out.push_back(segment.px_raw);
    return out;
  }

 private:
  std::unique_ptr<SegmentDetector> detector_;
  std::vector<RawSegment> found_;
};

/// Published detectors give x1 y1 x2 y2, pixel centres on integers.
class Published : public MeasuredDetector {
 public:
  std::vector<Segment2> segments() const override {
    std::vector<Segment2> out;
    for (const cv::Vec4f& line : lines_) {
      const Segment2 segment{{line[0], line[1]}, {line[2], line[3]}};
      if (segment.length() > 0.0) out.push_back(segment);
    }
    return out;
  }

 protected:
  std::vector<cv::Vec4f> lines_;
};

class Lsd final : public Published {
 public:
  explicit Lsd(int refinement) : detector_(cv::createLineSegmentDetector(refinement)) {}
  void run(const cv::Mat& gray) override { detector_->detect(gray, lines_); }

 private:
  cv::Ptr<cv::LineSegmentDetector> detector_;
};

using cv::ximgproc::EdgeDrawing;

EdgeDrawing::Params edLinesParams(int gradient_operator, int gradient, int anchor) {
  EdgeDrawing::Params params;
  params.EdgeDetectionOperator = gradient_operator;
  params.GradientThresholdValue = gradient;
  params.AnchorThresholdValue = anchor;
  params.NFAValidation = true;
  return params;
}

class EdLines final : public Published {
 public:
  explicit EdLines(const EdgeDrawing::Params& params) : params_(params) {}
  void run(const cv::Mat& gray) override {
    // An object that has seen another size gives other results than a new one.
    if (!detector_ || size_ != gray.size()) {
      detector_ = cv::ximgproc::createEdgeDrawing();
      detector_->setParams(params_);
      size_ = gray.size();
    }
    detector_->detectEdges(gray);
    detector_->detectLines(lines_);
  }

 private:
  EdgeDrawing::Params params_;
  cv::Ptr<EdgeDrawing> detector_;
  cv::Size size_;
};

class FastLines final : public Published {
 public:
  explicit FastLines(bool merge)
      : detector_(cv::ximgproc::createFastLineDetector(10, 1.414213562f, 50.0, 50.0, 3, merge)) {}
  void run(const cv::Mat& gray) override { detector_->detect(gray, lines_); }

 private:
  cv::Ptr<cv::ximgproc::FastLineDetector> detector_;
};

template <class T, class... Arguments>
std::function<std::unique_ptr<MeasuredDetector>()> maker(Arguments... arguments) {
  return [=] { return std::make_unique<T>(arguments...); };
}

}  // namespace

std::vector<DetectorEntry> measuredDetectors() {
  return {
      {kOurs, "ours, default parameters", true, false, maker<Own>("solis")},
      {"chapter", "ours: the published Solis flow, constants of the chapter's authors", false, false,
       maker<Own>("chapter")},
      {"hough", "ours: Canny 50/150 and probabilistic Hough 1 px, 1 deg, 30 votes, length 20, gap 3", false,
       false, maker<Own>("hough")},
      {kLsd, "OpenCV LineSegmentDetector, standard refinement", false, false,
       maker<Lsd>(static_cast<int>(cv::LSD_REFINE_STD))},
      {"lsd_nfa", "OpenCV LineSegmentDetector, advanced refinement (NFA)", false, false,
       maker<Lsd>(static_cast<int>(cv::LSD_REFINE_ADV))},
      {"edlines", "OpenCV EdgeDrawing, default: Prewitt, gradient 20, anchor 0, NFA", false, false,
       maker<EdLines>(EdgeDrawing::Params())},
      {"edlines_sobel", "OpenCV EdgeDrawing, Sobel, gradient 36, anchor 8, NFA", false, false,
       maker<EdLines>(edLinesParams(EdgeDrawing::SOBEL, 36, 8))},
      {kTunedEdLines, "OpenCV EdgeDrawing, Sobel, gradient 12, anchor 8, NFA", false, false,
       maker<EdLines>(edLinesParams(EdgeDrawing::SOBEL, 12, 8))},
      {"fld", "OpenCV FastLineDetector, default", false, false, maker<FastLines>(false)},
      {"fld_merge", "OpenCV FastLineDetector with merging", false, true, maker<FastLines>(true)},
  };
}

}  // namespace vismem
