// Palettes from drawn rooms: a floor with a painted line, a wall with a door, in light and shade, with noise
// and blur. Tests V3, B5.
#include "calibration/core/colours/palette_learner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>
#include <set>

namespace vismem {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kImages = 12;
const cv::Size kSize(320, 240);

cv::Scalar rgbOf(double hue_deg, double saturation, double value) {
  cv::Mat hsv(1, 1, CV_32FC3, cv::Scalar(hue_deg, saturation, value));
  cv::cvtColor(hsv, hsv, cv::COLOR_HSV2RGB);
  const auto& c = hsv.at<cv::Vec3f>(0, 0);
  return cv::Scalar(c[0], c[1], c[2]) * 255.0;
}

enum Surface { kFloor, kWall, kDoor, kLine, kSurfaces };

/// A view of a room, and which surface every pixel shows.
struct View {
  cv::Mat image;
  cv::Mat surface;
};

class DrawnRoom {
 public:
  /// @param drift  of the exposure from the first to the last image [powers of two].
  explicit DrawnRoom(unsigned seed, double drift = 0.0) : random_(seed) {
    colours_[kFloor] = rgbOf(uniform(0, 360), uniform(0.0, 0.25), uniform(0.16, 0.3));
    colours_[kWall] = rgbOf(uniform(20, 60), uniform(0.2, 0.4), uniform(0.6, 0.8));
    colours_[kDoor] = rgbOf(uniform(90, 330), uniform(0.65, 0.9), uniform(0.4, 0.7));
    colours_[kLine] = rgbOf(0, 0.0, uniform(0.88, 0.95));
    for (int i = 0; i < kImages; ++i)
      views_.push_back(draw(std::exp2(drift * (static_cast<double>(i) / (kImages - 1) - 0.5))));
  }

  const std::vector<View>& views() const { return views_; }

  PaletteLearner seen() const {
    PaletteLearner learner;
    const auto detector = makeSolisDetector();
    std::vector<RawSegment> segments;
    for (const View& view : views_) {
      detector->detect(view.image, segments);
      learner.addImage(view.image, segments);
    }
    return learner;
  }

  /// Well inside a surface of the first view.
  Eigen::Vector2i pixelOf(Surface surface) const {
    cv::Mat inside;
    cv::erode(views_[0].surface == static_cast<int>(surface), inside, cv::Mat::ones(7, 7, CV_8UC1));
    std::vector<cv::Point> points;
    cv::findNonZero(inside, points);
    const cv::Point middle = points.at(points.size() / 2);
    return {middle.x, middle.y};
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  View draw(double exposure) {
    const int foot = static_cast<int>(uniform(90, 130));
    View view{cv::Mat(kSize, CV_8UC3, colours_[kWall]), cv::Mat(kSize, CV_8UC1, cv::Scalar(kWall))};
    const auto fill = [&](const cv::Rect& where, Surface surface) {
      view.image(where).setTo(colours_[surface]);
      view.surface(where).setTo(surface);
    };
    fill({0, foot, kSize.width, kSize.height - foot}, kFloor);
    fill({static_cast<int>(uniform(20, 220)), 0, 60, foot}, kDoor);
    fill({0, static_cast<int>(uniform(160, 220)), kSize.width, 12}, kLine);
    cv::GaussianBlur(view.image, view.image, {}, 0.8);
    // Light falls off to one side.
    const double left = exposure * uniform(0.7, 1.1);
    const double right = exposure * uniform(0.7, 1.1);
    cv::Mat noisy;
    view.image.convertTo(noisy, CV_32FC3);
    std::normal_distribution<float> noise(0.0F, 2.0F);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const auto light = static_cast<float>(left + (right - left) * x / kSize.width);
        for (int k = 0; k < 3; ++k) {
          float& c = noisy.at<cv::Vec3f>(y, x)[k];
          c = light * c + noise(random_);
        }
      }
    }
    noisy.convertTo(view.image, CV_8UC3);
    return view;
  }

  std::mt19937 random_;
  std::array<cv::Scalar, kSurfaces> colours_;
  std::vector<View> views_;
};

/// Share of a surface's pixels, 3 px and more from its border, by class name.
std::map<std::string, double> classesOf(const Palette& palette, const std::vector<View>& views,
                                        Surface surface) {
  std::map<std::string, double> shares;
  double all = 0.0;
  for (const View& view : views) {
    cv::Mat inside;
    cv::erode(view.surface == static_cast<int>(surface), inside, cv::Mat::ones(7, 7, CV_8UC1));
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        if (inside.at<std::uint8_t>(y, x) == 0) continue;
        const auto& c = view.image.at<cv::Vec3b>(y, x);
        shares[palette.className(palette.classOf(c[0], c[1], c[2]))] += 1.0;
        all += 1.0;
      }
    }
  }
  for (auto& [name, share] : shares) share /= all;
  return shares;
}

std::string mostFrequent(const std::map<std::string, double>& shares) {
  return std::max_element(shares.begin(), shares.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

class PaletteLearnerDrawn : public testing::TestWithParam<unsigned> {};

TEST_P(PaletteLearnerDrawn, GivesEverySurfaceAClassOfItsOwnWithoutAClick) {
  const DrawnRoom room(GetParam());
  const LearntPalette learnt = room.seen().learn();
  const Palette palette = Palette::parse(learnt.text(), "learnt");
  std::set<std::string> names;
  for (const Surface surface : {kFloor, kWall, kDoor, kLine}) {
    const auto shares = classesOf(palette, room.views(), surface);
    const std::string name = mostFrequent(shares);
    EXPECT_TRUE(names.insert(name).second) << surface << " has the class of another one: " << name;
    EXPECT_GE(shares.at(name), 0.97) << surface << " " << name << "\n" << learnt.text();
    if (surface == kFloor) EXPECT_EQ(name, "floor") << learnt.text();
    // A door may be as bright as the floor, and then has no foot that the detector sees.
    if (surface == kWall || surface == kLine) {
      const Label& label = palette.label(palette.classNamed("floor"), palette.classNamed(name));
      EXPECT_EQ(label, name + (surface == kLine ? "_edge" : "_foot")) << learnt.text();
    }
  }
  EXPECT_LT(learnt.conflict_share, 0.02);
  EXPECT_THAT(learnt.notes, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Rooms, PaletteLearnerDrawn, testing::Range(1U, 13U));

// Research, section 9: a camera whose exposure is not locked while it learns.
TEST(PaletteLearner, AnExposureThatDriftsWhileLearningIsLearntOver) {
  for (const unsigned seed : {2U, 4U, 6U}) {
    const DrawnRoom room(seed, 0.5);
    const LearntPalette learnt = room.seen().learn();
    const Palette palette = Palette::parse(learnt.text(), "learnt");
    std::set<std::string> names;
    for (const Surface surface : {kFloor, kWall, kLine}) {
      const auto shares = classesOf(palette, room.views(), surface);
      const std::string name = mostFrequent(shares);
      EXPECT_TRUE(names.insert(name).second) << "seed " << seed << " " << surface << " is " << name;
      EXPECT_GE(shares.at(name), 0.9) << "seed " << seed << " " << name << "\n" << learnt.text();
    }
  }
}

TEST(PaletteLearner, ClicksNameTheClasses) {
  const DrawnRoom room(3);
  PaletteLearner learner = room.seen();
  const std::map<Surface, std::string> names{{kFloor, "ground"}, {kWall, "plaster"}, {kDoor, "floor"}};
  for (const auto& [surface, name] : names)
    learner.addClick(name, room.views()[0].image, room.pixelOf(surface));
  const LearntPalette learnt = learner.learn();
  const Palette palette = Palette::parse(learnt.text(), "learnt");
  for (const auto& [surface, name] : names)
    EXPECT_EQ(mostFrequent(classesOf(palette, room.views(), surface)), name) << learnt.text();
  EXPECT_THAT(learnt.notes, IsEmpty());
}

TEST(PaletteLearner, TwoColoursOfOneNameAreRegionsOfOneClass) {
  const DrawnRoom room(5);
  PaletteLearner learner = room.seen();
  learner.addClick("floor", room.views()[0].image, room.pixelOf(kFloor));
  for (const Surface surface : {kDoor, kWall})
    learner.addClick("wall", room.views()[0].image, room.pixelOf(surface));
  const LearntPalette learnt = learner.learn();
  const Palette palette = Palette::parse(learnt.text(), "learnt");
  for (const Surface surface : {kDoor, kWall})
    EXPECT_EQ(mostFrequent(classesOf(palette, room.views(), surface)), "wall") << learnt.text();
  for (const LearntPair& pair : learnt.pairs) EXPECT_NE(pair.a, pair.b);
}

TEST(PaletteLearner, SaysWhichClicksContradictEachOther) {
  const DrawnRoom room(7);
  PaletteLearner learner = room.seen();
  learner.addClick("floor", room.views()[0].image, room.pixelOf(kFloor));
  learner.addClick("wall", room.views()[0].image, room.pixelOf(kWall));
  learner.addClick("door", room.views()[0].image, room.pixelOf(kDoor));
  learner.addClick("locker", room.views()[0].image, room.pixelOf(kDoor));
  EXPECT_THAT(learner.learn().notes, Contains(AllOf(HasSubstr("door"), HasSubstr("locker"))));
}

TEST(PaletteLearner, WhatIsIgnoredNamesNoEdge) {
  const DrawnRoom room(9);
  PaletteLearner learner = room.seen();
  learner.addClick("ignored", room.views()[0].image, room.pixelOf(kLine));
  const LearntPalette learnt = learner.learn();
  const Palette palette = Palette::parse(learnt.text(), "learnt");
  EXPECT_EQ(mostFrequent(classesOf(palette, room.views(), kLine)), "ignored") << learnt.text();
  for (const LearntPair& pair : learnt.pairs) EXPECT_TRUE(pair.a != "ignored" && pair.b != "ignored");
  EXPECT_FALSE(learnt.pairs.empty());
}

TEST(PaletteLearner, WithoutEdgesSaysWhatIsMissing) {
  PaletteLearner learner;
  EXPECT_THROW(learner.learn(), std::runtime_error) << "no image at all";
  learner.addImage(cv::Mat(kSize, CV_8UC3, cv::Scalar(90, 90, 90)), {});
  EXPECT_THROW(learner.learn(), std::runtime_error);
}

TEST(ColourClusters, LightAndShadeOfOneColourAreOneCluster) {
  std::vector<Rgb> colours;
  for (int v = 60; v < 180; ++v) {
    colours.push_back({static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v / 2), 20});
    colours.push_back({20, static_cast<std::uint8_t>(v / 2), static_cast<std::uint8_t>(v)});
  }
  const ColourClusters found = clusterColours(colours, std::vector<double>(colours.size(), 1.0));
  ASSERT_EQ(found.count, 2U);
  for (std::size_t i = 2; i < colours.size(); ++i) EXPECT_EQ(found.cluster_of[i], found.cluster_of[i % 2]);
}

TEST(ColourClusters, AreCutBetweenColoursThatPeopleCallDifferent) {
  // One ramp from a red to a yellow, so near that it is one cluster.
  std::vector<Rgb> colours;
  for (int green = 100; green < 140; ++green) colours.push_back({160, static_cast<std::uint8_t>(green), 100});
  const ColourClusters one = clusterColours(colours, std::vector<double>(colours.size(), 1.0));
  ASSERT_EQ(one.count, 1U);
  const ColourClusters two = cutBetweenGroups(one, colours, {{0, 1, 2}, {37, 38, 39}}, 0.05);
  ASSERT_EQ(two.count, 2U);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (i < 15 || i >= 25) EXPECT_EQ(two.cluster_of[i], i < 15 ? 0U : 1U) << i;
  }
  EXPECT_EQ(cutBetweenGroups(one, colours, {{0, 1, 39}, {0, 38, 39}}, 0.05).count, 1U) << "they overlap";
  EXPECT_EQ(cutBetweenGroups(one, colours, {{0, 1, 2}}, 0.05).count, 1U) << "one name";
}

TEST(ColourRegion, RegionsThatAreApartDoNotOverlap) {
  // Two reds on both sides of hue 0, and a grey.
  const auto cloud = [](double hue_deg, double saturation, double value) {
    std::vector<ColorValues> colours;
    for (int i = -5; i <= 5; ++i)
      colours.push_back({std::fmod(hue_deg + i + 360.0, 360.0), saturation + i, value + i, true});
    return colours;
  };
  const auto regions =
      std::vector{regionOf(cloud(350, 80, 50)), regionOf(cloud(20, 80, 50)), regionOf(cloud(20, 6, 50))};
  EXPECT_FALSE(regions[0].is_grey);
  EXPECT_TRUE(regions[2].is_grey);
  const auto boxes = separateRegions(regions);
  EXPECT_NEAR(boxes[0].hue_deg.high, 5.0, 1.0) << "half way from 355 to 15";
  EXPECT_NEAR(boxes[1].hue_deg.low, 5.0, 1.0);
  EXPECT_GT(boxes[0].hue_deg.low, 300.0);
  EXPECT_LE(boxes[2].saturation_percent.high, boxes[1].saturation_percent.low + 1.0);
}

}  // namespace
}  // namespace vismem
