// The light of images relative to a palette's: correction and estimate.
// Tests V3.
#include "common/vision/light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <random>

#include "common/vision/light_estimator.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

const cv::Scalar kFloor(128, 122, 115);
const cv::Scalar kTape(150, 40, 35);
const cv::Scalar kSkirting(70, 52, 40);

std::shared_ptr<const Palette> roomPalette() {
  return std::make_shared<const Palette>(
      Palette::parse("class.red = hue 345..15 saturation 45..100 value 30..100\n"
                     "class.skirt = hue 5..32 saturation 25..60 value 12..31\n"
                     "class.floor = saturation 0..24 value 40..90\n"
                     "pair.tape = floor red\n"
                     "pair.skirting = floor skirt\n",
                     "room.palette"));
}

/// What a camera sees of a colour under a light: the inverse of the correction.
cv::Mat seenUnder(const ImageLight& light, const cv::Mat& image) {
  cv::Mat seen(image.size(), image.type());
  const Eigen::Vector2d middle(0.5 * (image.cols - 1), 0.5 * (image.rows - 1));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double r2 = (Eigen::Vector2d(x, y) - middle).squaredNorm() / middle.squaredNorm();
      for (int c = 0; c < 3; ++c) {
        const double value =
            image.at<cv::Vec3b>(y, x)[c] / 255.0 * (1.0 - light.vignette * r2) / light.gain[c];
        seen.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<std::uint8_t>(255.0 * std::pow(value, 1.0 / light.gamma));
      }
    }
  }
  return seen;
}

/// Strips of tape and skirting on a floor, and strips of colours that no pair names.
cv::Mat room(std::mt19937_64& random, const std::vector<cv::Scalar>& colors) {
  cv::Mat image(240, 320, CV_8UC3, kFloor);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector2d middle(30 + 260 * unit(random), 30 + 180 * unit(random));
    const double angle = M_PI * unit(random);
    const Eigen::Vector2d along = 40.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    fillQuad(image, stripeAlong({middle - along, middle + along}, 14.0), colors[i % colors.size()]);
  }
  addNoise(image, 2.0, random);
  return image;
}

/// Feeds images of rooms under one light.
void watch(LightEstimator& estimator, const ImageLight& light, int images, std::uint64_t seed,
           const std::vector<cv::Scalar>& colors) {
  std::mt19937_64 random(seed);
  const auto detector = makeSegmentDetector("solis");
  std::vector<RawSegment> segments;
  for (int i = 0; i < images; ++i) {
    const cv::Mat seen = seenUnder(light, room(random, colors));
    detector->detect(seen, segments);
    estimator.update(seen, segments);
  }
}

ImageLight drawn(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  ImageLight light;
  const double gain = std::exp(0.75 * unit(random));
  const double warm = unit(random);
  light.gain = {gain * std::exp(-0.2 * warm), gain, gain * std::exp(0.35 * warm)};
  return light;
}

TEST(LightTable, NeutralLightChangesNothing) {
  const LightTable table(ImageLight{});
  for (int value = 0; value < 256; ++value) {
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_EQ(table.at(0, channel, value), value);
      EXPECT_EQ(table.at(31, channel, value), value);
    }
  }
}

TEST(LightTable, UndoesGainGammaAndVignette) {
  ImageLight light;
  light.gain = {1.3, 1.6, 2.0};
  light.gamma = 0.8;
  light.vignette = 0.4;
  std::mt19937_64 random(3);
  const cv::Mat image = room(random, {kTape, kSkirting});
  cv::Mat corrected;
  LightTable(light).correct(seenUnder(light, image), corrected);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(corrected.at<cv::Vec3b>(y, x)[c], image.at<cv::Vec3b>(y, x)[c], 5) << x << ' ' << y;
      }
    }
  }
}

TEST(LightTable, AGreyImageStaysAsItIs) {
  ImageLight light;
  light.gain.setConstant(2.0);
  const cv::Mat image(20, 30, CV_8UC1, cv::Scalar(40));
  cv::Mat corrected;
  LightTable(light).correct(image, corrected);
  EXPECT_EQ(corrected.type(), CV_8UC1);
  EXPECT_EQ(corrected.at<std::uint8_t>(3, 3), 40);
}

TEST(Light, IsDescribedInWords) {
  ImageLight light;
  EXPECT_EQ(describe(light), "");
  light.gain.setConstant(2.0);
  EXPECT_EQ(describe(light), "images are 0.5 times as bright as the palette expects");
  light.gain = {0.8, 1.0, 1.5};
  light.vignette = 0.5;
  EXPECT_EQ(describe(light), "images are red 1.2 times, blue 0.7 times, darker in the corners by 0.5");
}

// Unless the palette still names an eighth of the edges as they are, and names them right.
TEST(LightEstimator, FindsDrawnLights) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const ImageLight light = drawn(random);
    LightEstimator estimator(roomPalette());
    watch(estimator, light, 25, seed, {kTape, kSkirting});
    if (!estimator.light().isNeutral()) ++found;
    EXPECT_GT(estimator.namedShare(), estimator.light().isNeutral() ? 0.12 : 0.9)
        << "seed " << seed << ", gain " << light.gain.transpose();
  }
  EXPECT_GE(found, 8);
}

TEST(LightEstimator, FindsAVignette) {
  ImageLight light;
  light.gain.setConstant(1.4);
  light.vignette = 0.5;
  LightEstimator estimator(roomPalette());
  watch(estimator, light, 25, 4, {kTape, kSkirting});
  EXPECT_GT(estimator.namedShare(), 0.9);
}

TEST(LightEstimator, KeepsTheNeutralLightOfAPalettesOwnImages) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    LightEstimator estimator(roomPalette());
    watch(estimator, {}, 25, seed, {kTape, kSkirting});
    EXPECT_TRUE(estimator.light().isNeutral()) << "seed " << seed;
  }
}

// Edges without a pair's colours say nothing about light.
TEST(LightEstimator, KeepsTheNeutralLightAmongForeignColours) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> level(20.0, 235.0);
    std::vector<cv::Scalar> colors{kTape, kSkirting};
    for (int i = 0; i < 4; ++i) colors.emplace_back(level(random), level(random), level(random));
    LightEstimator estimator(roomPalette());
    watch(estimator, {}, 25, seed, colors);
    EXPECT_TRUE(estimator.light().isNeutral())
        << "seed " << seed << ": " << estimator.light().gain.transpose() << ", gamma "
        << estimator.light().gamma << ", vignette " << estimator.light().vignette << ", named "
        << estimator.namedShare();
  }
}

const cv::Scalar kWood(110, 82, 62);

std::shared_ptr<const Palette> woodPalette() {
  return std::make_shared<const Palette>(
      Palette::parse("class.skirt = hue 5..32 saturation 25..60 value 18..31\n"
                     "class.wood = hue 5..32 saturation 25..60 value 31..62\n"
                     "class.floor = saturation 0..24 value 30..90\n"
                     "pair.skirting = floor skirt\n"
                     "pair.wood_foot = floor wood\n",
                     "wood.palette"));
}

// In dim light the palette takes wood for skirting, and has no name for skirting.
TEST(LightEstimator, EndsANeutralLightThatNamesWrongly) {
  ImageLight dim;
  dim.gain.setConstant(1.0 / 0.62);
  LightEstimator estimator(woodPalette());
  watch(estimator, dim, 25, 1, {kWood, kSkirting});
  EXPECT_GT(estimator.namedShare(), 0.9);
  EXPECT_GT(estimator.light().gain[1], 1.2);
}

// A brighter light would take skirting for wood, and name dark patches: two thirds as many edges again.
TEST(LightEstimator, KeepsANeutralLightThatNamesHalf) {
  const cv::Scalar patch(43, 32, 25);
  const cv::Scalar blue(30, 40, 160);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    LightEstimator estimator(woodPalette());
    watch(estimator, {}, 25, seed, {kSkirting, patch, kSkirting, patch, kSkirting, blue});
    EXPECT_TRUE(estimator.light().isNeutral()) << "seed " << seed;
    EXPECT_GT(estimator.namedShare(), 0.4) << "seed " << seed;
  }
}

// A brighter light would name dark patches on the floor; lines have the same name under both.
TEST(LightEstimator, KeepsANeutralLightWhoseNamesStay) {
  const auto palette = std::make_shared<const Palette>(
      Palette::parse("class.black = value 0..15\n"
                     "class.red = hue 345..15 saturation 45..100 value 30..100\n"
                     "class.floor = saturation 0..24 value 30..90\n"
                     "pair.line = floor black\n"
                     "pair.tape = floor red\n",
                     "lines.palette"));
  const cv::Scalar line(10, 10, 10);
  const cv::Scalar patch(60, 15, 12);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    LightEstimator estimator(palette);
    watch(estimator, {}, 25, seed, {line, patch, patch});
    EXPECT_TRUE(estimator.light().isNeutral()) << "seed " << seed;
    EXPECT_LT(estimator.namedShare(), 0.6) << "seed " << seed;
  }
}

TEST(LightEstimator, FollowsALampThatGoesOnAndOff) {
  LightEstimator estimator(roomPalette());
  watch(estimator, {}, 20, 1, {kTape, kSkirting});
  ImageLight dark;
  dark.gain.setConstant(2.0);
  watch(estimator, dark, 60, 2, {kTape, kSkirting});
  EXPECT_FALSE(estimator.light().isNeutral());
  EXPECT_GT(estimator.namedShare(), 0.9);
  watch(estimator, {}, 60, 3, {kTape, kSkirting});
  EXPECT_GT(estimator.namedShare(), 0.9);
  EXPECT_NEAR(estimator.light().gain[1], 1.0, 0.25);
}

TEST(LightEstimator, ReadsNothingFromGreyImages) {
  LightEstimator estimator(roomPalette());
  const cv::Mat grey(240, 320, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(estimator.update(grey, {{{{10, 10}, {90, 90}}, 40.0}}));
  EXPECT_TRUE(estimator.light().isNeutral());
}

}  // namespace
}  // namespace vismem
