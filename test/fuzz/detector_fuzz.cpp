// Segment detectors, labelling and merging on images of any size, stride, content and parameters (see V1-V4).
// Required for every image: finite ends inside it, minimum length, and the same result again, on a new
// object, after images of other sizes, and with another memory layout.
#include <sanitizer/asan_interface.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/vision/segment_detector.h"
#include "common/vision/segment_extractor.h"
#include "fuzz/byte_reader.h"

namespace vismem {
namespace {

#define HOLDS(condition)                                                                  \
  do {                                                                                    \
    if (!(condition)) {                                                                   \
      std::fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                       \
    }                                                                                     \
  } while (false)

cv::Size readSize(ByteReader& in) {
  const int longest = in.byte() % 16 == 0 ? 4096 : 512;
  switch (in.byte() % 8) {
    case 0:
      return {in.integer(1, 20), in.integer(1, 20)};  // around the smallest that is evaluated
    case 1:
      return {in.integer(16, longest), in.integer(16, 18)};
    case 2:
      return {in.integer(16, 18), in.integer(16, longest)};
    default:
      return {in.integer(16, 72), in.integer(16, 72)};
  }
}

/// Steps, bars, discs, gradients and noise: what edges are made of. Drawn one over another.
void paint(cv::Mat& image, ByteReader& in) {
  const auto point = [&] {
    return cv::Point(in.integer(-8, image.cols + 8), in.integer(-8, image.rows + 8));
  };
  const auto color = [&] { return cv::Scalar(in.byte(), in.byte(), in.byte()); };
  for (int shapes = in.byte() % 12; shapes > 0; --shapes) {
    switch (in.byte() % 6) {
      case 0:
        cv::line(image, point(), point(), color(), 1 + in.byte() % 9, cv::LINE_AA);
        break;
      case 1:
        cv::rectangle(image, point(), point(), color(), in.coin() ? cv::FILLED : 1);
        break;
      case 2:
        cv::circle(image, point(), in.byte(), color(), in.coin() ? cv::FILLED : 1);
        break;
      case 3: {
        const std::vector<cv::Point> corners{point(), point(), point()};
        cv::fillConvexPoly(image, corners, color(), cv::LINE_AA);
        break;
      }
      case 4: {  // a gradient, or teeth where it overflows
        const int step = in.byte();
        for (int y = 0; y < image.rows; ++y) {
          for (int x = 0; x < image.cols * image.channels(); ++x) {
            image.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>((x + y) * step / 16);
          }
        }
        break;
      }
      default: {  // raw bytes, repeated
        std::uint8_t bytes[16];
        for (std::uint8_t& byte : bytes) byte = in.byte();
        const int period = 1 + in.byte() % 16;
        for (int y = 0; y < image.rows; ++y) {
          for (int x = 0; x < image.cols * image.channels(); ++x) {
            image.ptr<std::uint8_t>(y)[x] ^= bytes[(x * (1 + y % 3) + y) % period];
          }
        }
      }
    }
  }
  // The rest as it comes.
  const std::size_t left = in.left();
  if (left == 0) return;
  std::vector<std::uint8_t> bytes(left);
  for (std::uint8_t& byte : bytes) byte = in.byte();
  std::size_t next = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols * image.channels(); ++x) {
      image.ptr<std::uint8_t>(y)[x] ^= bytes[next++ % left];
    }
  }
}

/// The same pixels in a buffer of their own: rows apart by more than their length, nothing after the last
/// pixel, and no right to look at what lies between the rows.
class TightCopy {
 public:
  TightCopy(const cv::Mat& image, std::size_t gap)
      : row_(image.cols * image.elemSize()),
        step_(row_ + gap),
        rows_(image.rows),
        buffer_(new std::uint8_t[step_ * (rows_ - 1) + row_]),
        view_(image.rows, image.cols, image.type(), buffer_.get(), step_) {
    image.copyTo(view_);
    for (std::size_t y = 0; y + 1 < rows_; ++y)
      ASAN_POISON_MEMORY_REGION(buffer_.get() + y * step_ + row_, gap);
  }
  ~TightCopy() {
    for (std::size_t y = 0; y + 1 < rows_; ++y) {
      ASAN_UNPOISON_MEMORY_REGION(buffer_.get() + y * step_ + row_, step_ - row_);
    }
  }
  TightCopy(const TightCopy&) = delete;
  TightCopy& operator=(const TightCopy&) = delete;
  const cv::Mat& view() const { return view_; }

 private:
  std::size_t row_;
  std::size_t step_;
  std::size_t rows_;
  std::unique_ptr<std::uint8_t[]> buffer_;
  cv::Mat view_;
};

std::vector<RawSegment> detect(SegmentDetector& detector, const cv::Mat& image) {
  std::vector<RawSegment> found;
  detector.detect(image, found);
  return found;
}

bool same(const std::vector<RawSegment>& x, const std::vector<RawSegment>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const RawSegment& a, const RawSegment& b) {
    return a.px_raw.a == b.px_raw.a && a.px_raw.b == b.px_raw.b && a.strength == b.strength;
  });
}

bool same(const std::vector<ImageSegment>& x, const std::vector<ImageSegment>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const ImageSegment& a, const ImageSegment& b) {
    return a.px.a == b.px.a && a.px.b == b.px.b && a.strength == b.strength && a.label == b.label;
  });
}

void check(const std::vector<RawSegment>& found, const cv::Size& size, double minimum_length_px) {
  if (std::min(size.width, size.height) < 16) HOLDS(found.empty());
  for (const RawSegment& segment : found) {
    for (const Eigen::Vector2d& end : {segment.px_raw.a, segment.px_raw.b}) {
      HOLDS(end.allFinite());
      HOLDS(end.minCoeff() >= -0.5 && end.x() <= size.width - 0.5 && end.y() <= size.height - 0.5);
    }
    HOLDS(segment.px_raw.length() > 0.0);
    HOLDS(segment.px_raw.length() >= minimum_length_px);
    HOLDS(std::isfinite(segment.strength) && segment.strength >= 0.0);
  }
}

struct MadeDetector {
  std::unique_ptr<SegmentDetector> detector;
  double minimum_length_px = 0.0;
};

/// The same bytes make the same detector.
MadeDetector makeDetector(ByteReader in) {
  switch (in.byte() % 8) {
    case 0:
      return {makeSegmentDetector("chapter"), 0.0};
    case 1:
      return {makeSegmentDetector("hough"), 0.0};
    case 2: {
      SolisParams params;
      params.minimum_length_px = in.real(0.0, 40.0);
      params.minimum_contrast = in.real(0.0, 60.0);
      params.noise_factor = in.real(0.0, 10.0);
      params.bridge_missing_point = in.integer(0, 1) != 0;
      params.line_tolerance_px = in.real(0.3, 2.0);
      params.merge_gap_px = in.real(0.0, 20.0);
      params.merge_offset_px = in.real(0.0, 3.0);
      params.merge_angle_rad = in.real(0.0, 0.3);
      params.bridge_share = in.real(0.0, 3.0);
      params.bridge_px = in.real(0.0, 60.0);
      params.minimum_certainty = in.real(0.0, 40.0);
      params.maximum_shift_px = in.real(0.0, 0.5);
      return {makeSolisDetector(params), params.minimum_length_px};
    }
    default:
      return {makeSolisDetector(), SolisParams().minimum_length_px};
  }
}
constexpr std::size_t kDetectorBytes = 32;

void fuzzDetector(ByteReader in, const std::uint8_t* detector_bytes) {
  const ByteReader choice(detector_bytes, kDetectorBytes);
  const cv::Size size = readSize(in);
  const bool color = in.coin();
  const std::size_t gap = in.byte();
  const cv::Size other_size(in.integer(1, 64), in.integer(1, 64));
  cv::Mat image(size, color ? CV_8UC3 : CV_8UC1, cv::Scalar::all(in.byte()));
  paint(image, in);

  const MadeDetector made = makeDetector(choice);
  const auto first = detect(*made.detector, image);
  check(first, size, made.minimum_length_px);
  HOLDS(same(detect(*made.detector, image), first));

  cv::Mat other(other_size, CV_8UC1, cv::Scalar(90));
  cv::rectangle(other, {other_size.width / 4, other_size.height / 4}, {60, 60}, cv::Scalar(200), cv::FILLED);
  check(detect(*made.detector, other), other_size, made.minimum_length_px);
  const TightCopy tight(image, gap);
  HOLDS(same(detect(*made.detector, tight.view()), first));

  // A part of a larger image knows nothing of what is around it.
  cv::Mat large(size.height + 7, size.width + 9, image.type(), cv::Scalar::all(255));
  cv::Mat part = large(cv::Rect(4, 3, size.width, size.height));
  image.copyTo(part);
  HOLDS(same(detect(*makeDetector(choice).detector, part), first));
}

const std::shared_ptr<const Palette>& palette() {
  static const auto loaded = std::make_shared<const Palette>(
      Palette::parse("class.grass = hue 70..170 saturation 25..100 value 8..100\n"
                     "class.line = saturation 0..25 value 45..100\n"
                     "class.dark = value 0..30\n"
                     "pair.stripe_edge = grass line\n"
                     "pair.border = dark line\n",
                     "fuzz.palette"));
  return loaded;
}

void fuzzExtractor(ByteReader in) {
  const cv::Size size = readSize(in);
  ExtractorParams params;
  params.detector = segmentDetectorNames()[in.byte() % segmentDetectorNames().size()];
  params.merge = {in.real(0.0, 0.3), in.real(0.0, 4.0), in.real(0.0, 30.0)};
  params.minimum_length_px = in.real(0.0, 40.0);
  params.labeller.samples = in.integer(1, 20);
  params.labeller.trim = in.real(0.0, 0.45);
  params.labeller.minimum_majority = in.real(0.0, 1.0);
  CameraIntrinsics intrinsics = intrinsicsFromFieldOfView(size.width, size.height, in.real(0.3, 2.0));
  if (in.coin()) {
    intrinsics.k1 = in.real(-0.3, 0.3);
    intrinsics.k2 = in.real(-0.1, 0.1);
    intrinsics.p1 = in.real(-0.01, 0.01);
    intrinsics.p2 = in.real(-0.01, 0.01);
  }
  const auto colors = in.coin() ? palette() : nullptr;
  cv::Mat image(size, in.coin() ? CV_8UC3 : CV_8UC1, cv::Scalar::all(in.byte()));
  paint(image, in);

  const auto segments = SegmentExtractor(params, colors).extract(image, intrinsics);
  for (const ImageSegment& segment : segments) {
    HOLDS(segment.px.a.allFinite() && segment.px.b.allFinite());
    HOLDS(segment.px.length() > 0.0 && segment.px.length() >= params.minimum_length_px);
    HOLDS(std::isfinite(segment.strength) && segment.strength >= 0.0);
    HOLDS(!segment.label.empty());
    if (!colors || image.channels() == 1) HOLDS(segment.label == kUnknownLabel);
  }
  // Nothing is left to merge, and the order of the input is of no matter.
  auto again = segments;
  std::reverse(again.begin(), again.end());
  SegmentMerger().merge(again, params.merge);
  HOLDS(again.size() == segments.size());
  const TightCopy tight(image, 5);
  HOLDS(same(SegmentExtractor(params, colors).extract(tight.view(), intrinsics), segments));
}

}  // namespace
}  // namespace vismem

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismem;
  static const bool once = [] {
    cv::setNumThreads(1);
    return true;
  }();
  (void)once;
  if (size < kDetectorBytes + 1) return 0;
  ByteReader in(data, size);
  if (in.byte() % 4 == 3) {
    fuzzExtractor(in);
  } else {
    fuzzDetector(ByteReader(data + 1 + kDetectorBytes, size - 1 - kDetectorBytes), data + 1);
  }
  return 0;
}
