// Labels from the colours on both sides, and the extraction of labelled segments from an image.
// Tests V3, V4.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>

#include "common/geometry/angles.h"
#include "common/vision/edge_sampling.h"
#include "common/vision/segment_extractor.h"
#include "common/vision/segment_labeller.h"
#include "support/build_paths.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

const cv::Scalar kGrass(60, 100, 60);
const cv::Scalar kLine(190, 195, 185);
const cv::Scalar kBlue(40, 110, 180);

std::shared_ptr<const Palette> fieldPalette() {
  return std::make_shared<const Palette>(
      loadPalette(std::filesystem::path(VISMEM_SOURCE_DIR) / "cfg/maps/field.palette"));
}

cv::Mat stripeImage(const Segment2& middle, double width_px, const cv::Scalar& ground,
                    const cv::Scalar& paint) {
  cv::Mat image(240, 320, CV_8UC3, ground);
  fillQuad(image, stripeAlong(middle, width_px), paint);
  return image;
}

SegmentSides labelSegment(const cv::Mat& image, const Segment2& px, const Palette& palette,
                          const LabellerParams& params) {
  SideSamples samples(palette, params);
  samples.takeWhole(image, px);
  return samples.sides(0, params.samples);
}

TEST(Palettes, ThoseWeShipAreLoaded) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(VISMEM_SOURCE_DIR) / "cfg/maps")) {
    if (entry.path().extension() != ".palette") continue;
    ++count;
    EXPECT_FALSE(loadPalette(entry.path()).labels().empty()) << entry.path();
  }
  EXPECT_GE(count, 1);
}

// Noise makes many windows close calls; some samples lie outside the image.
TEST(SideSamples, AWindowHasTheLabelOfThatPartOfTheSegment) {
  const auto palette = fieldPalette();
  cv::Mat image = stripeImage({{20, 230}, {300, 30}}, 12.0, kGrass, kLine);
  cv::Mat noise(image.size(), CV_8UC3);
  cv::RNG(7).fill(noise, cv::RNG::UNIFORM, 0, 70);
  image += noise;
  const Segment2 edge{{5, 246}, {310, 28}};
  LabellerParams window;
  window.samples = 3;
  window.trim = 0.0;
  const Eigen::Vector2d along = (edge.b - edge.a) / edge.length();
  constexpr int kWindows = 180;
  SideSamples samples(*palette, window);
  samples.take(image, edge, 1.0, 2.0, kWindows + 2);
  std::set<Label> seen;
  for (int i = 0; i < kWindows; ++i) {
    const Segment2 part{edge.a + 2.0 * i * along, edge.a + (2.0 * i + 6.0) * along};
    const SegmentSides expected = labelSegment(image, part, *palette, window);
    const SegmentSides sides = samples.sides(i, 3);
    EXPECT_EQ(sides.label, expected.label) << i;
    EXPECT_EQ(sides.bright, expected.bright) << i;
    EXPECT_EQ(sides.dark, expected.dark) << i;
    EXPECT_EQ(samples.label(i, 3), expected.label) << i;
    seen.insert(expected.label);
  }
  EXPECT_GT(seen.size(), 1U);
}

// The colours of a surface near the border of its class: noise moves half of the samples out of it.
TEST(LabelSegment, NamesNoisySurfacesByTheirMeanColour) {
  const Palette palette = Palette::parse(
      "class.floor = saturation 12..100\nclass.paint = saturation 0..11.99\npair.edge = floor paint\n",
      "a.palette");
  const Segment2 middle{{40, 120}, {280, 120}};
  // Saturations 13.5 % and 10.5 %.
  const cv::Mat clean = stripeImage(middle, 40.0, cv::Scalar(100, 93, 86.5), cv::Scalar(200, 189, 179));
  const Segment2 edge{{50, 100}, {270, 100}};
  LabellerParams majority_only;
  majority_only.maximum_scatter = 0.0;
  int named = 0;
  int by_majority = 0;
  constexpr int kSeeds = 50;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    cv::Mat noise(clean.size(), CV_16SC3);
    cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0.0, 10.0);
    cv::Mat wide;
    clean.convertTo(wide, CV_16SC3);
    wide += noise;
    cv::Mat image;
    wide.convertTo(image, CV_8UC3);
    for (int i = 0; i < 10; ++i) {
      const Segment2 part{edge.a + Eigen::Vector2d(20.0 * i, 0.0),
                          edge.a + Eigen::Vector2d(20.0 * i + 18.0, 0.0)};
      named += labelSegment(image, part, palette, {}).label == "edge";
      by_majority += labelSegment(image, part, palette, majority_only).label == "edge";
    }
  }
  EXPECT_GE(named, 9 * kSeeds) << "of " << 10 * kSeeds;
  EXPECT_LE(by_majority, 6 * kSeeds) << "the majority alone";
}

TEST(LabelSegment, GivesAMixtureOfTwoSurfacesNoClassOfItsOwn) {
  // Half of the darker side is black, half is white: their mean is the grey of a class.
  const Palette palette = Palette::parse(
      "class.black = value 0..10\nclass.white = value 90..100\nclass.grey = value 40..60\npair.edge = white "
      "grey\n",
      "a.palette");
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(250, 250, 250));
  for (int u = 0; u < image.cols; u += 2) image(cv::Rect(u, 100, 1, 60)) = cv::Scalar(5, 5, 5);
  EXPECT_EQ(labelSegment(image, {{50, 100}, {250, 100}}, palette, {}).label, kUnknownLabel);
}

TEST(LabelSegment, NamesThePairOnBothSides) {
  const auto palette = fieldPalette();
  cv::Mat image(240, 320, CV_8UC3, kGrass);
  fillQuad(image, squareAt({160, 120}, 100, 0), kLine);
  const Segment2 right_side{{210, 165}, {210, 75}};  // upwards: the bright inside is on the left
  const SegmentSides sides = labelSegment(image, right_side, *palette, {});
  EXPECT_EQ(palette->className(sides.bright), "line");
  EXPECT_EQ(palette->className(sides.dark), "grass");
  EXPECT_EQ(sides.label, "stripe_edge");
}

TEST(LabelSegment, OtherColoursAreUnknownButTheirClassesAreReported) {
  const auto palette = fieldPalette();
  cv::Mat image(240, 320, CV_8UC3, kBlue);
  fillQuad(image, squareAt({160, 120}, 100, 0), kLine);
  const SegmentSides sides = labelSegment(image, {{210, 165}, {210, 75}}, *palette, {});
  EXPECT_EQ(palette->className(sides.bright), "line");
  EXPECT_EQ(palette->className(sides.dark), "none");
  EXPECT_EQ(sides.label, kUnknownLabel);
}

TEST(LabelSegment, SamplesOutsideTheImageDoNotCount) {
  const auto palette = fieldPalette();
  cv::Mat image(240, 320, CV_8UC3, kGrass);
  fillQuad(image, squareAt({300, 120}, 36, 0), kLine);  // x from 282 to 318, one pixel from the border
  EXPECT_EQ(labelSegment(image, {{318, 135}, {318, 105}}, *palette, {}).label, kUnknownLabel);
  EXPECT_EQ(labelSegment(image, {{282, 105}, {282, 135}}, *palette, {}).label, "stripe_edge");
  EXPECT_EQ(labelSegment(image, {{-50, -50}, {-20, -20}}, *palette, {}).label, kUnknownLabel);
}

TEST(LabelSegment, AGrayImageOrAPointIsUnknown) {
  const auto palette = fieldPalette();
  EXPECT_EQ(labelSegment(cv::Mat(50, 50, CV_8UC1, cv::Scalar(9)), {{1, 1}, {40, 40}}, *palette, {}).label,
            kUnknownLabel);
  EXPECT_EQ(labelSegment(cv::Mat(50, 50, CV_8UC3, kGrass), {{9, 9}, {9, 9}}, *palette, {}).label,
            kUnknownLabel);
}

TEST(SegmentExtractor, LabelsBothEdgesOfStripesOfEveryWidthAndDirection) {
  const auto palette = fieldPalette();
  SegmentExtractor extractor({}, palette);
  const auto intrinsics = intrinsicsFromFieldOfView(320, 240, 1.0);
  std::mt19937_64 random(8);
  for (const double width_px : {2.0, 3.0, 5.0, 12.0, 40.0}) {
    for (const int degrees : {0, 15, 40, 75, 90}) {
      const Eigen::Vector2d d(std::cos(degToRad(degrees)), std::sin(degToRad(degrees)));
      const Segment2 middle{Eigen::Vector2d(160, 120) - 80 * d, Eigen::Vector2d(160, 120) + 80 * d};
      cv::Mat image = stripeImage(middle, width_px, kGrass, kLine);
      blur(image, 0.6);
      addNoise(image, 4.0, random);
      double length_px[2] = {0.0, 0.0};
      double unknown_px = 0.0;
      for (const auto& segment : extractor.extract(image, intrinsics)) {
        if (lineAngleDifference(segment.px.direction(), middle.direction()) > 0.1) continue;
        const double length = segment.px.length();
        if (segment.label == "stripe_edge") {
          length_px[(segment.px.b - segment.px.a).dot(d) > 0.0 ? 0 : 1] += length;
          EXPECT_GT((Eigen::Vector2d(160, 120) - segment.px.middle()).dot(leftNormal(segment.px)), 0.0);
        } else {
          unknown_px += length;
        }
      }
      EXPECT_GT(length_px[0], 140) << width_px << " px at " << degrees << " deg";
      EXPECT_GT(length_px[1], 140) << width_px << " px at " << degrees << " deg";
      EXPECT_LT(unknown_px, 20) << width_px << " px at " << degrees << " deg";
    }
  }
}

TEST(SegmentExtractor, APostBeforeAWallIsNoStripe) {
  SegmentExtractor extractor({}, fieldPalette());
  const Segment2 middle{{160, 40}, {163, 200}};
  cv::Mat image = stripeImage(middle, 12, kLine, kBlue);
  blur(image, 0.8);
  for (const auto& segment : extractor.extract(image, intrinsicsFromFieldOfView(320, 240, 1.0))) {
    EXPECT_EQ(segment.label, kUnknownLabel);
  }
}

// A stripe drawn where the lens shows a straight line: its undistorted edges are straight and in place.
TEST(SegmentExtractor, TakesTheDistortionOutOfTheEnds) {
  CameraIntrinsics intrinsics = intrinsicsFromFieldOfView(320, 240, 1.0);
  intrinsics.k1 = -0.25;
  const double y_ideal = 30.0;
  cv::Mat image(240, 320, CV_8UC3, kGrass);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double depth = undistortPixel(intrinsics, Eigen::Vector2d(x, y)).y() - y_ideal;
      const double share = std::clamp(0.5 + depth, 0.0, 1.0);
      for (int c = 0; c < 3; ++c) {
        image.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<std::uint8_t>(kGrass[c] + share * (kLine[c] - kGrass[c]));
      }
    }
  }
  const double bend_px =
      distortPixel(intrinsics, {10, y_ideal}).y() - distortPixel(intrinsics, {160, y_ideal}).y();
  EXPECT_GT(std::abs(bend_px), 4.0);
  double length_px = 0.0;
  SegmentExtractor extractor({}, fieldPalette());
  for (const auto& segment : extractor.extract(image, intrinsics)) {
    EXPECT_EQ(segment.label, "stripe_edge");
    // The sensor sees an arc, cut into chords within the detector's tolerance of 0.8 px and joined.
    EXPECT_NEAR(segment.px.a.y(), y_ideal, 1.5);
    EXPECT_NEAR(segment.px.b.y(), y_ideal, 1.5);
    EXPECT_LT(segment.px.b.x(), segment.px.a.x());  // bright below: the way is to the left
    length_px += segment.px.length();
  }
  EXPECT_GT(length_px, 290);
}

TEST(SegmentExtractor, WithoutAPaletteAllIsUnknownAndShortOnesAreDropped) {
  ExtractorParams params;
  params.minimum_length_px = 50.0;
  SegmentExtractor extractor(params, nullptr);
  cv::Mat image(240, 320, CV_8UC3, kGrass);
  fillQuad(image, squareAt({100, 120}, 80, 0.1), kLine);
  fillQuad(image, squareAt({250, 120}, 30, 0.1), kLine);
  const auto segments = extractor.extract(image, intrinsicsFromFieldOfView(320, 240, 1.0));
  EXPECT_EQ(segments.size(), 4u);
  for (const auto& segment : segments) {
    EXPECT_EQ(segment.label, kUnknownLabel);
    EXPECT_GE(segment.px.length(), 50.0);
  }
}

TEST(SegmentExtractor, WantsTheIntrinsicsOfItsImage) {
  SegmentExtractor extractor({}, nullptr);
  try {
    extractor.extract(cv::Mat(240, 320, CV_8UC3, kGrass), intrinsicsFromFieldOfView(640, 480, 1.0));
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "image of 320x240 px (its intrinsics are for 640x480)");
  }
}

}  // namespace
}  // namespace vismem
