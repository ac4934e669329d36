// Tests B4.
#include "localization/core/gaze/gaze_advisor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

/// A corridor along x, 1.5 m wide. Doors to the left at x = -6 and x = 4: poses at -8 and 2 have
/// equal views, except for a door to the right at x = 3.5.
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

/// Equal time in view of all bearings.
void lookAllAround(GazeAdvisor& advisor, StampUs end_us) {
  for (int i = 0; i < 6; ++i) {
    ImageAnalysis view = test::emptyView(degToRad(60 * i - 150), degToRad(-15));
    view.stamp_us = end_us - kSecondUs * (5 - i) / 10;
    auto snapshot = std::make_shared<MemorySnapshot>();
    advisor.addView({snapshot, std::make_shared<ImageAnalysis>(view)});
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
  GazeAdvisor advisor_{GazeAdvisorParams{}, {}, {}, map_};
};

/// Of the direction nearest to a pan.
const GazeAdvice& towards(const std::vector<GazeAdvice>& advice, double pan_rad) {
  return *std::min_element(advice.begin(), advice.end(), [&](const GazeAdvice& a, const GazeAdvice& b) {
    return std::abs(a.direction.pan_rad - pan_rad) < std::abs(b.direction.pan_rad - pan_rad);
  });
}

TEST_F(GazeAdvisorTest, PrefersTheViewThatDiscriminatesBetweenTheRaces) {
  lookAllAround(advisor_, kSecondUs);
  const auto advice =
      advisor_.advise(estimateWith({race(kHere, 0.5, false), race(kThere, 0.5, true)}), update());
  ASSERT_FALSE(advice.empty());
  EXPECT_TRUE(shows(advice.front(), {1.5, -0.75})) << radToDeg(advice.front().direction.pan_rad);
  // Backwards both places show two plain walls.
  for (const GazeAdvice& one : advice) {
    if (std::abs(one.direction.pan_rad) < degToRad(140)) continue;
    EXPECT_LT(one.informative_m, advice.front().informative_m);
    EXPECT_LT(one.score, advice.front().score);
  }
}

// The entropy of the winner's pose would fail here: the winner is wrong and explains its view.
TEST_F(GazeAdvisorTest, PrefersItForAWrongWinnerWithMostBelief) {
  lookAllAround(advisor_, kSecondUs);
  const auto advice =
      advisor_.advise(estimateWith({race(kHere, 0.05, false), race(kThere, 0.95, true)}), update());
  EXPECT_TRUE(shows(advice.front(), {1.5, -0.75})) << radToDeg(advice.front().direction.pan_rad);
}

// After a kidnapping the winner keeps nearly all belief for a second, while it explains nothing.
TEST_F(GazeAdvisorTest, ARefutedWinnerHasNoInfluence) {
  const Pose2 stale{10, 0, 0};
  const PoseEstimate jumped = estimateWith(
      {race(stale, 0.98, true, 0.0), race(kHere, 0.01, false, 0.95), race(kThere, 0.01, false, 0.95)});
  const PoseEstimate known = estimateWith({race(kHere, 0.5, true, 0.95), race(kThere, 0.5, false, 0.95)});
  const auto expected = advisor_.advise(known, update());
  const auto advice = advisor_.advise(jumped, update());
  EXPECT_NEAR(advice.front().direction.pan_rad, expected.front().direction.pan_rad, 1e-9);
  EXPECT_NEAR(advice.front().informative_m, expected.front().informative_m,
              0.2 * expected.front().informative_m);
}

TEST_F(GazeAdvisorTest, ViewsOnTheWayCountAndLateViewsCountLess) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  // The discriminating door lies ahead to the right; the camera looks back on that side.
  const MemoryUpdate back = test::viewFrom(map_, kHere, kSecondUs, degToRad(-159), degToRad(-15));
  GazeAdvisorParams patient;
  patient.patience_s = 1.5;
  patient.half_novelty_s = 0.2;
  const GazeAdvisor advisor(patient, {}, {}, map_);
  const auto advice = advisor.advise(estimate, back);
  const double there = towards(advice, degToRad(-30)).score;
  // A turn past the door shows it, too; staying behind does not.
  EXPECT_GT(towards(advice, degToRad(30)).score, 0.5 * there);
  EXPECT_LT(towards(advice, degToRad(-159)).score, there);
  GazeAdvisorParams slow = patient;
  slow.head_speed_radps = degToRad(30);
  const GazeAdvisor sluggish(slow, {}, {}, map_);
  EXPECT_LT(towards(sluggish.advise(estimate, back), degToRad(-30)).score, 0.9 * there);
}

TEST_F(GazeAdvisorTest, AMovingHeadBrakesBeforeItTurnsBack) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  StampUs now = 0;
  const double left = degToRad(75);
  const MemoryUpdate there = test::viewFrom(map_, kHere, kSecondUs, left, degToRad(-15));
  // The score of the door, ahead to the right, for a camera that looks left and came from a pan.
  const auto scoreComingFrom = [&](double pan_rad) {
    for (const double pan : {pan_rad, left}) {
      ImageAnalysis view = test::emptyView(pan, degToRad(-15));
      view.stamp_us = now += kSecondUs / 10;
      advisor_.addView({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(view)});
    }
    advisor_.reset();
    return towards(advisor_.advise(estimate, there), degToRad(-30)).score;
  };
  const double resting = scoreComingFrom(left);
  EXPECT_GT(scoreComingFrom(left + degToRad(15)), 1.02 * resting) << "turns right already";
  EXPECT_LT(scoreComingFrom(left - degToRad(15)), 0.98 * resting) << "turns left";
  EXPECT_NEAR(scoreComingFrom(left), resting, 1e-9) << "stopped";
}

TEST_F(GazeAdvisorTest, NoveltyFallsWithTimeInViewAndRecovers) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  const auto lookAhead = [&](StampUs stamp_us) {
    ImageAnalysis view = test::emptyView(degToRad(-15), degToRad(-15));
    view.stamp_us = stamp_us;
    advisor_.addView({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(view)});
  };
  const double fresh = towards(advisor_.advise(estimate, update()), degToRad(-15)).score;
  for (int i = 0; i < 30; ++i) lookAhead(kSecondUs * i / 10);
  const GazeAdvice seen = towards(advisor_.advise(estimate, update()), degToRad(-15));
  EXPECT_LT(seen.score, 0.5 * fresh);
  EXPECT_LT(seen.novelty, 0.3);
  // The same at 30 Hz: time counts, not the number of images.
  advisor_.reset();
  EXPECT_NEAR(towards(advisor_.advise(estimate, update()), degToRad(-15)).score, fresh, 1e-9);
  for (int i = 0; i < 90; ++i) lookAhead(kSecondUs * i / 30);
  EXPECT_NEAR(towards(advisor_.advise(estimate, update()), degToRad(-15)).score, seen.score,
              0.15 * seen.score);
  // Long after, with a view elsewhere.
  ImageAnalysis behind = test::emptyView(degToRad(150), degToRad(-15));
  behind.stamp_us = 30 * kSecondUs;
  advisor_.addView({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(behind)});
  EXPECT_GT(towards(advisor_.advise(estimate, update()), degToRad(-15)).score, 0.75 * fresh);
}

TEST_F(GazeAdvisorTest, AnAbandonedDirectionIsNoLongerTheBest) {
  const PoseEstimate estimate = estimateWith({race(kHere, 0.5, true), race(kThere, 0.5, false)});
  const GazeAdvice best = advisor_.advise(estimate, update()).front();
  advisor_.abandon(best.direction, update());
  const GazeAdvice next = advisor_.advise(estimate, update()).front();
  EXPECT_GT(std::abs(angleDifference(best.direction.pan_rad, next.direction.pan_rad)), degToRad(20));
}

TEST_F(GazeAdvisorTest, WithoutRacesItPrefersUnseenBearings) {
  for (int i = 0; i < 20; ++i) {
    ImageAnalysis view = test::emptyView(degToRad(-60 + 30 * (i % 5)), degToRad(-15));
    view.stamp_us = kSecondUs * i / 10;
    advisor_.addView({std::make_shared<MemorySnapshot>(), std::make_shared<ImageAnalysis>(view)});
  }
  const auto advice = advisor_.advise(PoseEstimate{}, update());
  // viewFrom stands at heading 0 in odom.
  EXPECT_GT(std::abs(advice.front().direction.pan_rad), degToRad(90));
  EXPECT_NEAR(advice.front().novelty, 1.0, 1e-6);
}

// With poor health the robot is probably at neither place: all lines count, also where the races agree.
TEST_F(GazeAdvisorTest, TheBeliefInNoRaceGrowsWithPoorHealth) {
  const auto behind = [&](double health) {
    const auto advice = advisor_.advise(
        estimateWith({race(kHere, 0.5, false, health), race(kThere, 0.5, true, health)}), update());
    return towards(advice, degToRad(159)).informative_m;
  };
  EXPECT_GT(behind(0.2), 2.0 * behind(0.9));
}

TEST_F(GazeAdvisorTest, TheGazePointLiesOnTheAxis) {
  const MemoryUpdate update = this->update();
  for (const GazeAdvice& one : advisor_.advise(estimateWith({race(kHere, 1.0, true)}), update)) {
    const Eigen::Vector3d p_robot = transform(inverse(update.snapshot->T_odom_robot), one.p_odom);
    const Eigen::Vector3d ray = p_robot - Eigen::Vector3d(0, 0, 0.45);
    EXPECT_NEAR(angleDifference(std::atan2(ray.y(), ray.x()), one.direction.pan_rad), 0.0, 1e-6);
    EXPECT_NEAR(std::atan2(ray.z(), ray.head<2>().norm()), one.direction.tilt_rad, 1e-6);
    EXPECT_GE(p_robot.z(), -1e-9);
  }
}

}  // namespace
}  // namespace vismem
