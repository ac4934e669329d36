// Units of localization/core/gaze_advisor and visible_map (SPEC B4).
#include "localization/core/gaze_advisor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "localization/core/random_engine.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

/// A corridor along x, 1.5 m wide. To the left doors at x = -6 and x = 4: a robot at -8 sees what one at 2
/// sees. What tells them apart: a door to the right at x = 3.5.
SegmentMap twoPlaces() {
  SegmentMap map;
  map.segments = {wall(-12, 0.75, -6.4, 0.75),
                  wall(-6.4, 0.75, -5.6, 0.75, "door_foot"),
                  wall(-5.6, 0.75, 3.6, 0.75),
                  wall(3.6, 0.75, 4.4, 0.75, "door_foot"),
                  wall(4.4, 0.75, 12, 0.75),
                  wall(-12, -0.75, 3.1, -0.75),
                  wall(3.1, -0.75, 3.9, -0.75, "door_foot"),
                  wall(3.9, -0.75, 12, -0.75)};
  return map;
}

const Pose2 kHere{2, 0, 0};
const Pose2 kThere{-8, 0, 0};

PoseEstimate estimateWith(std::vector<RaceReport> races) {
  PoseEstimate estimate;
  estimate.P = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  for (const RaceReport& race : races) {
    if (race.winner) estimate.T_world_robot = race.T_world_robot;
  }
  estimate.races = std::move(races);
  return estimate;
}

RaceReport race(const Pose2& pose, double weight, bool winner, double health = 0.8) {
  RaceReport report;
  report.T_world_robot = pose;
  report.weight = weight;
  report.health = health;
  report.winner = winner;
  return report;
}

/// All around was seen alike, so that novelty says nothing.
void lookAllAround(GazeAdvisor& advisor, StampUs end_us) {
  for (int i = 0; i < 6; ++i) {
    ImageAnalysis view = test::emptyView(degToRad(60 * i - 150), degToRad(-15));
    view.stamp_us = end_us - kSecondUs * (5 - i) / 10;
    auto snapshot = std::make_shared<MemorySnapshot>();
    advisor.look({snapshot, std::make_shared<ImageAnalysis>(view)});
  }
}

bool shows(const GazeAdvice& advice, const Eigen::Vector2d& p_robot) {
  const ImageAnalysis view = test::emptyView(advice.direction.pan_rad, advice.direction.tilt_rad);
  return CameraView(view.intrinsics, view.T_robot_camera).shows(p_robot);
}

class GazeAdvisorTest : public testing::Test {
 protected:
  MemoryUpdate update() const { return test::viewFrom(map_, kHere, kSecondUs, 0.0, degToRad(-15)); }

  const SegmentMap map_ = twoPlaces();
  GazeAdvisor advisor_{GazeAdvisorParams{}, localizerPreset(LocalizationMode::kDefault), map_};
};

/// Of the direction nearest to a pan.
const GazeAdvice& towards(const std::vector<GazeAdvice>& advice, double pan_rad) {
  return *std::min_element(advice.begin(), advice.end(), [&](const GazeAdvice& a, const GazeAdvice& b) {
    return std::abs(a.direction.pan_rad - pan_rad) < std::abs(b.direction.pan_rad - pan_rad);
  });
}

TEST_F(GazeAdvisorTest, LooksAtWhatTellsTheRacesApart) {
  lookAllAround(advisor_, kSecondUs);
  const auto advice =
      advisor_.advise(estimateWith({race(kHere, 0.5, false), race(kThere, 0.5, true)}), update());
  ASSERT_FALSE(advice.empty());
  EXPECT_TRUE(shows(advice.front(), {1.5, -0.75})) << radToDeg(advice.front().direction.pan_rad);
  // Backwards both places show two plain walls: only a place that is none of them could show something else
  // there.
  for (const GazeAdvice& one : advice) {
    if (std::abs(one.direction.pan_rad) < degToRad(140)) continue;
    EXPECT_LT(one.telling_m, advice.front().telling_m);
    EXPECT_LT(one.score, advice.front().score);
  }
}

// Entropy of a trusted pose fails exactly here: the winner is wrong, and content with what it sees.
TEST_F(GazeAdvisorTest, LooksThereToo_WhenTheWinnerIsWrongAndStrong) {
  lookAllAround(advisor_, kSecondUs);
  const auto advice =
      advisor_.advise(estimateWith({race(kHere, 0.05, false), race(kThere, 0.95, true)}), update());
  EXPECT_TRUE(shows(advice.front(), {1.5, -0.75})) << radToDeg(advice.front().direction.pan_rad);
}

// After a kidnapping the winner keeps nearly all of the belief for a second, while it explains nothing.
TEST_F(GazeAdvisorTest, AWinnerThatExplainsNothingDoesNotSayWhereToLook) {
  const Pose2 stale{10, 0, 0};
  const PoseEstimate jumped = estimateWith(
      {race(stale, 0.98, true, 0.0), race(kHere, 0.01, false, 0.95), race(kThere, 0.01, false, 0.95)});
  const PoseEstimate known = estimateWith({race(kHere, 0.5, true, 0.95), race(kThere, 0.5, false, 0.95)});
  const auto expected = advisor_.advise(known, update());
  const auto advice = advisor_.advise(jumped, update());
  EXPECT_NEAR(advice.front().direction.pan_rad, expected.front().direction.pan_rad, 1e-9);
  EXPECT_NEAR(advice.front().telling_m, expected.front().telling_m, 0.2 * expected.front().telling_m);
}

TEST_F(GazeAdvisorTest, WhatIsSeenOnTheWayCountsAndWhatTakesLongCountsLess) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  // What tells them apart lies ahead to the right; the camera looks back on that side.
  const MemoryUpdate back = test::viewFrom(map_, kHere, kSecondUs, degToRad(-159), degToRad(-15));
  GazeAdvisorParams patient;
  patient.patience_s = 1.5;
  patient.repeat_s = 0.2;
  const GazeAdvisor advisor(patient, localizerPreset(LocalizationMode::kDefault), map_);
  const auto advice = advisor.advise(estimate, back);
  const double there = towards(advice, degToRad(-30)).score;
  // To go past it shows it too; to stay behind does not.
  EXPECT_GT(towards(advice, degToRad(30)).score, 0.5 * there);
  EXPECT_LT(towards(advice, degToRad(-159)).score, there);
  GazeAdvisorParams slow = patient;
  slow.head_speed_radps = degToRad(30);
  const GazeAdvisor sluggish(slow, localizerPreset(LocalizationMode::kDefault), map_);
  EXPECT_LT(towards(sluggish.advise(estimate, back), degToRad(-30)).score, 0.9 * there);
}

TEST_F(GazeAdvisorTest, AHeadThatTurnsGoesOnBeforeItTurnsBack) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  StampUs now = 0;
  const double left = degToRad(75);
  const MemoryUpdate there = test::viewFrom(map_, kHere, kSecondUs, left, degToRad(-15));
  // The score of what tells them apart, ahead to the right, for a camera that looks left and came from a pan.
  const auto scoreComingFrom = [&](double pan_rad) {
    for (const double pan : {pan_rad, left}) {
      ImageAnalysis view = test::emptyView(pan, degToRad(-15));
      view.stamp_us = now += kSecondUs / 10;
      advisor_.look({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(view)});
    }
    advisor_.forget();
    return towards(advisor_.advise(estimate, there), degToRad(-30)).score;
  };
  const double resting = scoreComingFrom(left);
  EXPECT_GT(scoreComingFrom(left + degToRad(15)), 1.02 * resting) << "it turns right already";
  EXPECT_LT(scoreComingFrom(left - degToRad(15)), 0.98 * resting) << "it turns left";
  EXPECT_NEAR(scoreComingFrom(left), resting, 1e-9) << "it stopped";
}

TEST_F(GazeAdvisorTest, WhatWasSeenTellsLessAndIsNewAgainLater) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  const auto lookAhead = [&](StampUs stamp_us) {
    ImageAnalysis view = test::emptyView(degToRad(-15), degToRad(-15));
    view.stamp_us = stamp_us;
    advisor_.look({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(view)});
  };
  const double fresh = towards(advisor_.advise(estimate, update()), degToRad(-15)).score;
  for (int i = 0; i < 30; ++i) lookAhead(kSecondUs * i / 10);
  const GazeAdvice seen = towards(advisor_.advise(estimate, update()), degToRad(-15));
  EXPECT_LT(seen.score, 0.5 * fresh);
  EXPECT_LT(seen.novelty, 0.3);
  // The same by thirty images a second: it is time that counts.
  advisor_.forget();
  EXPECT_NEAR(towards(advisor_.advise(estimate, update()), degToRad(-15)).score, fresh, 1e-9);
  for (int i = 0; i < 90; ++i) lookAhead(kSecondUs * i / 30);
  EXPECT_NEAR(towards(advisor_.advise(estimate, update()), degToRad(-15)).score, seen.score,
              0.15 * seen.score);
  // Long after, by a look elsewhere.
  ImageAnalysis behind = test::emptyView(degToRad(150), degToRad(-15));
  behind.stamp_us = 30 * kSecondUs;
  advisor_.look({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(behind)});
  EXPECT_GT(towards(advisor_.advise(estimate, update()), degToRad(-15)).score, 0.75 * fresh);
}

TEST_F(GazeAdvisorTest, ADirectionThatIsGivenUpIsNotTheBestAnyMore) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  const GazeAdvice best = advisor_.advise(estimate, update()).front();
  advisor_.giveUp(best.direction, update());
  const GazeAdvice next = advisor_.advise(estimate, update()).front();
  EXPECT_GT(std::abs(angleDifference(best.direction.pan_rad, next.direction.pan_rad)), degToRad(20));
}

TEST_F(GazeAdvisorTest, WithoutRacesItLooksWhereItDidNotLook) {
  for (int i = 0; i < 20; ++i) {
    ImageAnalysis view = test::emptyView(degToRad(-60 + 30 * (i % 5)), degToRad(-15));
    view.stamp_us = kSecondUs * i / 10;
    advisor_.look({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(view)});
  }
  const auto advice = advisor_.advise(PoseEstimate{}, update());
  // viewFrom stands at heading 0 in odom.
  EXPECT_GT(std::abs(advice.front().direction.pan_rad), degToRad(90));
  EXPECT_NEAR(advice.front().novelty, 1.0, 1e-6);
}

// With poor health the robot is probably at neither place: then all lines count, also where the races agree.
TEST_F(GazeAdvisorTest, ANoneOfThesePartGrowsWithPoorHealth) {
  const auto behind = [&](double health) {
    const auto advice = advisor_.advise(
        estimateWith({race(kHere, 0.5, false, health), race(kThere, 0.5, true, health)}), update());
    return towards(advice, degToRad(159)).telling_m;
  };
  EXPECT_GT(behind(0.2), 2.0 * behind(0.9));
}

TEST_F(GazeAdvisorTest, ThePlaceLiesOnTheAxis) {
  const MemoryUpdate update = this->update();
  for (const GazeAdvice& one : advisor_.advise(estimateWith({race(kHere, 1.0, true)}), update)) {
    const Eigen::Vector3d p_robot = transform(inverse(update.snapshot->T_odom_robot), one.p_odom);
    const Eigen::Vector3d ray = p_robot - Eigen::Vector3d(0, 0, 0.45);
    EXPECT_NEAR(angleDifference(std::atan2(ray.y(), ray.x()), one.direction.pan_rad), 0.0, 1e-6);
    EXPECT_NEAR(std::atan2(ray.z(), ray.head<2>().norm()), one.direction.tilt_rad, 1e-6);
    EXPECT_GE(p_robot.z(), -1e-9);
  }
}

TEST(VisibleMap, WallsHideWhatIsBehindThemButNotThemselves) {
  SegmentMap map;
  map.segments = {wall(2, -3, 2, 3), wall(3, -3, 3, 3), wall(1, -0.2, 1, 0.2, "marking")};
  const MapIndex index(map, {});
  const VisibleMap visible(index, std::vector<std::string>{"skirting", "*_foot"});
  std::vector<VisiblePoint> points;
  visible.around({0, 0, 0}, 5.0, {}, nullptr, points);
  double nearer = 0.0;
  double hidden = 0.0;
  double marking = 0.0;
  for (const VisiblePoint& point : points) {
    (point.p_robot.x() < 1.5 ? marking : point.p_robot.x() < 2.5 ? nearer : hidden) += point.length_m;
  }
  EXPECT_NEAR(marking, 0.4, 1e-9);
  EXPECT_NEAR(nearer, 6.0, 1e-9);  // a marking does not hide the wall
  EXPECT_EQ(hidden, 0.0);
  // Something stands 0.5 m ahead: it hides a part of the wall, and the marking behind it.
  const std::vector<Segment2> obstacle{{{0.5, -0.1}, {0.5, 0.1}}};
  visible.around({0, 0, 0}, 5.0, obstacle, nullptr, points);
  for (const VisiblePoint& point : points) {
    EXPECT_GT(std::abs(std::atan2(point.p_robot.y(), point.p_robot.x())), degToRad(10));
  }
}

TEST(VisibleMap, SeesOnlyWhatTheCameraShows) {
  SegmentMap map;
  map.segments = {wall(-3, 1, 3, 1)};
  const MapIndex index(map, {});
  const VisibleMap visible(index, std::vector<std::string>{});
  const ImageAnalysis view = test::emptyView(degToRad(90), degToRad(-20));
  const CameraView camera(view.intrinsics, view.T_robot_camera);
  std::vector<VisiblePoint> points;
  visible.around({0, 0, 0}, 5.0, {}, &camera, points);
  ASSERT_FALSE(points.empty());
  for (const VisiblePoint& point : points) {
    EXPECT_LT(std::abs(point.p_robot.x()), std::tan(degToRad(31)) * std::hypot(1.0, 0.45));
  }
}

/// With a view only what can hide something in it is looked at: nothing else may come of that.
TEST(VisibleMapProperty, AViewShowsWhatIsSeenAllAroundAndLiesInIt) {
  RandomEngine engine(23);
  SegmentMap map;
  for (int i = 0; i < 300; ++i) {
    const double x = uniform(engine, -10, 10);
    const double y = uniform(engine, -10, 10);
    const double length = uniform(engine, 0.1, 4.0);
    const double direction = uniform(engine, -3, 3);
    map.segments.push_back(wall(x, y, x + length * std::cos(direction), y + length * std::sin(direction),
                                i % 3 == 0 ? "marking" : "skirting"));
  }
  const MapIndex index(map, {});
  const VisibleMap visible(index, std::vector<std::string>{"skirting"});
  std::size_t shown = 0;
  std::size_t hidden = 0;
  for (int i = 0; i < 300; ++i) {
    const ImageAnalysis image = test::emptyView(uniform(engine, -3, 3), degToRad(uniform(engine, -90, 0)));
    const CameraView camera(image.intrinsics, image.T_robot_camera);
    const Pose2 pose{uniform(engine, -10, 10), uniform(engine, -10, 10), uniform(engine, -3, 3)};
    const std::vector<Segment2> obstacle{{{1.0, -0.2}, {1.0, 0.2}}};
    std::vector<VisiblePoint> around;
    visible.around(pose, 4.0, obstacle, nullptr, around);
    std::erase_if(around, [&](const VisiblePoint& point) { return !camera.shows(point.p_robot); });
    std::vector<VisiblePoint> in_view;
    visible.around(pose, 4.0, obstacle, &camera, in_view);
    ASSERT_EQ(in_view.size(), around.size()) << i;
    for (std::size_t k = 0; k < around.size(); ++k) {
      EXPECT_EQ(in_view[k].p_robot, around[k].p_robot);
      EXPECT_EQ(in_view[k].segment, around[k].segment);
    }
    shown += around.size();
    std::vector<VisiblePoint> open;
    VisibleMap(index, std::vector<std::string>{}).around(pose, 4.0, {}, &camera, open);
    hidden += open.size() - around.size();
  }
  EXPECT_GT(shown, 500u);
  EXPECT_GT(hidden, 500u);
}

TEST(VisibleMap, KnowsNamesAndEndingsOfLabels) {
  const std::vector<std::string> names{"skirting", "*_foot"};
  EXPECT_TRUE(isListed("skirting", names));
  EXPECT_TRUE(isListed("door_foot", names));
  EXPECT_FALSE(isListed("line", names));
  EXPECT_FALSE(isListed("foot", names));
}

}  // namespace
}  // namespace vismem
