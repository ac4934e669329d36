// The three segment detectors on images whose edges are known.
// Tests V1, V2.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/vision/edge_sampling.h"
#include "common/vision/segment_detector.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

std::vector<RawSegment> detect(SegmentDetector& detector, const cv::Mat& image) {
  std::vector<RawSegment> out;
  detector.detect(image, out);
  return out;
}

bool same(const std::vector<RawSegment>& x, const std::vector<RawSegment>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const RawSegment& a, const RawSegment& b) {
    return a.px_raw.a == b.px_raw.a && a.px_raw.b == b.px_raw.b && a.strength == b.strength;
  });
}

/// Detected with the ends nearest to those of `side` (either order), and the larger of the two end distances.
double endError(const std::vector<RawSegment>& found, const Segment2& side) {
  double best = 1e9;
  for (const auto& segment : found) {
    const Segment2& px = segment.px_raw;
    best = std::min(best, std::min(std::max((px.a - side.a).norm(), (px.b - side.b).norm()),
                                   std::max((px.a - side.b).norm(), (px.b - side.a).norm())));
  }
  return best;
}

cv::Mat squareImage(const Quad& square, double dark = 60, double bright = 140) {
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(dark));
  fillQuad(image, square, cv::Scalar::all(bright));
  return image;
}

// A bright square of 80 px about (160, 120): sides at x = 120 and 200, y = 80 and 160. The bright inside is
// on the left of every side, so the sides run counter-clockwise as a person sees the picture.
TEST(SolisDetector, WorkedExampleSquare) {
  const auto detector = makeSolisDetector();
  const auto found = detect(*detector, squareImage(squareAt({160, 120}, 80, 0)));
  ASSERT_EQ(found.size(), 4u);
  const Segment2 sides[] = {
      {{120, 160}, {200, 160}}, {{200, 160}, {200, 80}}, {{200, 80}, {120, 80}}, {{120, 80}, {120, 160}}};
  for (const auto& side : sides) {
    const auto match = std::find_if(found.begin(), found.end(), [&](const RawSegment& segment) {
      return (segment.px_raw.a - side.a).norm() < 1.5 && (segment.px_raw.b - side.b).norm() < 1.5;
    });
    ASSERT_NE(match, found.end()) << "side from " << side.a.transpose();
    EXPECT_LT(distanceToLine(match->px_raw.a, side), 0.05);
    EXPECT_LT(distanceToLine(match->px_raw.b, side), 0.05);
    EXPECT_NEAR(match->strength, 80, 2);
  }
}

TEST(SolisDetector, FindsTurnedSquaresUnderNoiseToAFractionOfAPixel) {
  const auto detector = makeSolisDetector();
  double squared_sum = 0.0;
  double end_error_sum = 0.0;
  int ends = 0;
  int extra = 0;
  std::mt19937_64 random(11);
  for (int degrees = 0; degrees < 90; degrees += 5) {
    const Quad square = squareAt({160.3, 119.6}, 90, degToRad(degrees));
    cv::Mat image = squareImage(square);
    blur(image, 0.7);
    addNoise(image, 3.0, random);
    const auto found = detect(*detector, image);
    extra += static_cast<int>(found.size()) - 4;
    for (int i = 0; i < 4; ++i) {
      const Segment2 side{square.corner[i], square.corner[(i + 1) % 4]};
      // Blur rounds the corners: an edge ends a little before its corner.
      EXPECT_LT(endError(found, side), 2.5) << degrees << " deg, side " << i;
      end_error_sum += endError(found, side);
      for (const auto& segment : found) {
        const Segment2& px = segment.px_raw;
        if (distanceToSegment(px.middle(), side) > 3.0) continue;
        EXPECT_GT((square.corner[(i + 2) % 4] - px.middle()).dot(leftNormal(px)), 0.0);  // bright inside left
        squared_sum += std::pow(distanceToLine(px.a, side), 2) + std::pow(distanceToLine(px.b, side), 2);
        ends += 2;
      }
    }
  }
  EXPECT_EQ(extra, 0);
  EXPECT_LT(end_error_sum / (18 * 4), 1.2);        // of the worse end of each side
  EXPECT_LT(std::sqrt(squared_sum / ends), 0.15);  // EDLines: 0.16 on such images
}

TEST(SolisDetector, SeesBothEdgesOfAThinStripe) {
  const auto detector = makeSolisDetector();
  std::mt19937_64 random(5);
  for (const double width_px : {2.0, 3.0, 5.0, 8.0}) {
    for (const int degrees : {0, 20, 45, 70, 90}) {
      const Eigen::Vector2d d(std::cos(degToRad(degrees)), std::sin(degToRad(degrees)));
      const Eigen::Vector2d middle(160.2, 120.4);
      const Segment2 line{middle - 70 * d, middle + 70 * d};
      cv::Mat image(240, 320, CV_8UC1, cv::Scalar(70));
      fillQuad(image, stripeAlong(line, width_px), cv::Scalar::all(150));
      addNoise(image, 2.0, random);
      double length_px[2] = {0.0, 0.0};
      for (const auto& segment : detect(*detector, image)) {
        if (lineAngleDifference(segment.px_raw.direction(), line.direction()) > 0.1) continue;
        // The stripe is on the left: each edge runs its own way.
        length_px[(segment.px_raw.b - segment.px_raw.a).dot(d) > 0.0 ? 0 : 1] += segment.px_raw.length();
        EXPECT_GT((middle - segment.px_raw.middle()).dot(leftNormal(segment.px_raw)), 0.0);
        // A line much thinner than the smoothing looks wider than it is, by under a pixel.
        EXPECT_NEAR(distanceToLine(segment.px_raw.middle(), line), 0.5 * width_px, 0.5);
      }
      EXPECT_GT(length_px[0], 120) << width_px << " px at " << degrees << " deg";
      EXPECT_GT(length_px[1], 120) << width_px << " px at " << degrees << " deg";
    }
  }
}

TEST(SolisDetector, SeesNothingInNoise) {
  const auto detector = makeSolisDetector();
  std::mt19937_64 random(3);
  for (const double sigma : {0.0, 1.0, 5.0, 15.0, 40.0}) {
    int found = 0;
    for (int i = 0; i < 5; ++i) {
      cv::Mat image(240, 320, CV_8UC1, cv::Scalar(128));
      addNoise(image, sigma, random);
      found += static_cast<int>(detect(*detector, image).size());
    }
    EXPECT_LE(found, 1) << "sigma " << sigma;
  }
}

TEST(SolisDetector, EstimatedNoiseDoesNotDependOnEdges) {
  const Quad square = squareAt({160, 120}, 120, 0.3);
  for (const double sigma : {2.0, 6.0, 20.0}) {
    std::mt19937_64 random(1);
    cv::Mat image = squareImage(square, 100, 160);
    addNoise(image, sigma, random);
    std::vector<RawSegment> found;
    makeSolisDetector()->detect(image, found);
    EXPECT_GE(found.size(), 4u) << sigma;
  }
}

class EveryDetector : public testing::TestWithParam<std::string> {};

TEST_P(EveryDetector, FindsTheSidesOfASquareWithTheBrightSideLeft) {
  const auto detector = makeSegmentDetector(GetParam());
  const Quad square = squareAt({160, 120}, 120, degToRad(20));
  const auto found = detect(*detector, squareImage(square, 40, 200));
  for (int i = 0; i < 4; ++i) {
    const Segment2 side{square.corner[i], square.corner[(i + 1) % 4]};
    double length_px = 0.0;
    for (const auto& segment : found) {
      const Segment2& px = segment.px_raw;
      if (lineAngleDifference(px.direction(), side.direction()) > 0.15) continue;
      if (distanceToSegment(px.middle(), side) > 4.0) continue;  // the published flow is up to 3 px beside
      length_px = std::max(length_px, px.length());
      EXPECT_GT((Eigen::Vector2d(160, 120) - px.middle()).dot(leftNormal(px)), 0.0);
      EXPECT_GT(segment.strength, 60.0);
    }
    EXPECT_GT(length_px, 80.0) << "side " << i;
  }
}

TEST_P(EveryDetector, TakesAnySizeAndKeepsInsideTheImage) {
  const auto detector = makeSegmentDetector(GetParam());
  std::mt19937_64 random(9);
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(15, 240), cv::Size(16, 16), cv::Size(17, 33),
                              cv::Size(321, 239), cv::Size(1280, 960)}) {
    for (const int type : {CV_8UC1, CV_8UC3}) {
      cv::Mat image(size, type, cv::Scalar::all(40));
      const double side_px = 0.6 * std::min(size.width, size.height);
      fillQuad(image, squareAt({0.5 * size.width, 0.5 * size.height}, side_px, 0.1), cv::Scalar::all(220));
      addNoise(image, 2.0, random);
      const auto found = detect(*detector, image);
      if (std::min(size.width, size.height) < 16) {
        EXPECT_TRUE(found.empty());
      }
      if (size.width == 1280) {
        EXPECT_FALSE(found.empty());
      }
      for (const auto& segment : found) {
        for (const auto* end : {&segment.px_raw.a, &segment.px_raw.b}) {
          EXPECT_GE(end->minCoeff(), -0.5);
          EXPECT_LE(end->x(), size.width - 0.5);
          EXPECT_LE(end->y(), size.height - 0.5);
        }
        EXPECT_GT(segment.px_raw.length(), 0.0);
        EXPECT_GE(segment.strength, 0.0);
      }
    }
  }
}

TEST_P(EveryDetector, RemembersNothing) {
  const auto detector = makeSegmentDetector(GetParam());
  const cv::Mat image = squareImage(squareAt({150, 110}, 100, 0.2));
  const auto first = detect(*detector, image);
  detect(*detector, cv::Mat(480, 640, CV_8UC1, cv::Scalar(7)));
  detect(*detector, squareImage(squareAt({100, 100}, 50, 0.7)));
  EXPECT_TRUE(same(detect(*detector, image), first));
  EXPECT_TRUE(same(detect(*makeSegmentDetector(GetParam()), image), first));
}

TEST_P(EveryDetector, PartsOfLargerImagesAndGrayInColourAreTheSame) {
  const auto detector = makeSegmentDetector(GetParam());
  cv::Mat large(300, 400, CV_8UC1, cv::Scalar(255));
  const cv::Mat image = squareImage(squareAt({150, 110}, 100, 0.2));
  cv::Mat part = large(cv::Rect(40, 30, 320, 240));
  image.copyTo(part);
  ASSERT_FALSE(part.isContinuous());
  const auto first = detect(*detector, image);
  EXPECT_TRUE(same(detect(*detector, part), first));
  cv::Mat color;
  cv::cvtColor(image, color, cv::COLOR_GRAY2RGB);
  EXPECT_TRUE(same(detect(*detector, color), first));
}

TEST_P(EveryDetector, RefusesOtherPixelTypes) {
  const auto detector = makeSegmentDetector(GetParam());
  try {
    detect(*detector, cv::Mat(240, 320, CV_16UC1, cv::Scalar(7)));
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "image type CV_16UC1 (must be CV_8UC1 or CV_8UC3)");
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryDetector, testing::ValuesIn(segmentDetectorNames()),
                         [](const auto& test) { return test.param; });

TEST(SegmentDetector, AnUnknownNameIsAnErrorThatNamesTheKnownOnes) {
  try {
    makeSegmentDetector("lsd");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "unknown segment detector \"lsd\" (known: solis, chapter, hough)");
  }
}

}  // namespace
}  // namespace vismem
