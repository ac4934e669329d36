// Tests L1, L2, L6, L7, L8, L12.
#include "localization/core/localizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/geometry/angles.h"
#include "localization/corridor_world.h"

namespace vismem {
namespace {

using test::CorridorParams;
using test::CorridorWorld;

class InBothModes : public testing::TestWithParam<LocalizationMode> {};
INSTANTIATE_TEST_SUITE_P(Modes, InBothModes,
                         testing::Values(LocalizationMode::kDefault, LocalizationMode::kChapter),
                         [](const auto& which) {
                           return which.param == LocalizationMode::kDefault ? "Default" : "Chapter";
                         });

bool isNear(const PoseEstimate& estimate, const Pose2& truth) {
  return estimate.T_world_robot && (estimate.T_world_robot->position() - truth.position()).norm() < 0.5 &&
         std::abs(angleDifference(estimate.T_world_robot->theta, truth.theta)) < degToRad(15);
}

double positionError(const PoseEstimate& estimate, const Pose2& truth) {
  return (estimate.T_world_robot->position() - truth.position()).norm();
}

/// The synthetic world has a memory and no images.
LocalizerParams paramsOf(LocalizationMode mode) {
  LocalizerParams params = localizerPreset(mode);
  params.health.source = ObservationSource::kMemory;
  return params;
}

/// Without calibration of odometry, for tests that compare with odometry.
LocalizerParams withoutCalibration(LocalizerParams params) {
  params.robust.filter.odometry_bias.setZero();
  return params;
}

struct Outcome {
  bool settled_in_time = false;  ///< near the truth for 2 s, within the limit
  double mean_error_m = 0.0;     ///< from then to the end, losses included
};

Outcome drive(Localizer& localizer, CorridorWorld& world, double seconds, double limit_s) {
  Outcome outcome;
  const double start_s = world.seconds();
  double since_s = -1.0;
  double sum = 0.0;
  int count = 0;
  while (world.seconds() < start_s + seconds) {
    const PoseEstimate estimate = localizer.update(world.next());
    if (!outcome.settled_in_time) {
      if (!isNear(estimate, world.truth())) {
        since_s = -1.0;
      } else if (since_s < 0.0) {
        since_s = world.seconds();
      }
      outcome.settled_in_time =
          since_s >= 0.0 && world.seconds() >= since_s + 2.0 && world.seconds() <= start_s + limit_s;
    } else {
      sum += estimate.T_world_robot ? positionError(estimate, world.truth()) : 10.0;
      ++count;
    }
  }
  outcome.mean_error_m = count > 0 ? sum / count : 1e9;
  return outcome;
}

TEST_P(InBothModes, FindsItselfFromAnUnknownStart) {
  int good = 0;
  for (std::uint64_t seed = 201; seed <= 210; ++seed) {
    CorridorWorld world({}, seed);
    Localizer localizer(paramsOf(GetParam()), test::corridorMap(), seed);
    const Outcome outcome = drive(localizer, world, 45.0, 30.0);
    good += outcome.settled_in_time && outcome.mean_error_m < 0.15;
  }
  EXPECT_GE(good, 8) << "of seeds 201..210";
}

TEST(Localizer, DefaultModeSurvivesOneFalseSegmentForEveryTwo) {
  CorridorParams params;
  params.false_share = 0.5;
  int good = 0;
  for (std::uint64_t seed = 201; seed <= 210; ++seed) {
    CorridorWorld world(params, seed);
    Localizer localizer(paramsOf(LocalizationMode::kDefault), test::corridorMap(), seed);
    const Outcome outcome = drive(localizer, world, 45.0, 30.0);
    good += outcome.settled_in_time && outcome.mean_error_m < 0.15;
  }
  EXPECT_GE(good, 8) << "of seeds 201..210";
}

TEST_P(InBothModes, RecoversFromAKidnapping) {
  int good = 0;
  for (std::uint64_t seed = 221; seed <= 225; ++seed) {
    CorridorWorld world({}, seed);
    Localizer localizer(paramsOf(GetParam()), test::corridorMap(), seed);
    drive(localizer, world, 30.0, 30.0);
    world.kidnap();
    good += drive(localizer, world, 60.0, 60.0).settled_in_time;
  }
  EXPECT_GE(good, 4) << "of seeds 221..225";
}

TEST_P(InBothModes, SameSeedSameResult) {
  std::vector<PoseEstimate> runs[2];
  for (auto& run : runs) {
    CorridorWorld world({}, 7);
    Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 7);
    for (int i = 0; i < 100; ++i) run.push_back(localizer.update(world.next()));
  }
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    ASSERT_EQ(runs[0][i].T_world_robot, runs[1][i].T_world_robot) << i;
    ASSERT_EQ(runs[0][i].reliability, runs[1][i].reliability) << i;
    ASSERT_EQ(runs[0][i].races.size(), runs[1][i].races.size()) << i;
  }
}

TEST_P(InBothModes, ThePoseIsTheWinnersPose) {
  CorridorWorld world({}, 8);
  Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 8);
  int with_rivals = 0;
  for (int i = 0; i < 300; ++i) {
    const PoseEstimate estimate = localizer.update(world.next());
    if (!estimate.T_world_robot) continue;
    int winners = 0;
    double weights = 0.0;
    for (const RaceReport& race : estimate.races) {
      weights += race.weight;
      if (!race.winner) continue;
      ++winners;
      EXPECT_EQ(race.T_world_robot, *estimate.T_world_robot);
    }
    EXPECT_EQ(winners, 1);
    EXPECT_NEAR(weights, 1.0, 1e-9);
    EXPECT_LE(estimate.races.size(), 10u);
    with_rivals += estimate.races.size() > 1;
  }
  EXPECT_GT(with_rivals, 20);
}

TEST_P(InBothModes, WeakEvidenceGivesLowReliability) {
  // One short piece of wall for 20 s: it fits many poses.
  Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 1);
  for (int i = 0; i < 100; ++i) {
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = i * 200'000;
    MemorySegment segment;
    segment.odom = {{1.0, 0.7, 0.0}, {1.5, 0.7, 0.0}};
    segment.label = "skirting";
    segment.confirmed = true;
    segment.last_seen_us = snapshot->stamp_us;
    snapshot->segments.push_back(segment);
    const PoseEstimate estimate = localizer.update({snapshot, std::make_shared<ImageAnalysis>()});
    EXPECT_LT(estimate.reliability, 0.5) << i;
  }
}

TEST_P(InBothModes, BetweenTicksThePoseFollowsOdometry) {
  CorridorWorld world({}, 9);
  Localizer localizer(withoutCalibration(paramsOf(GetParam())), test::corridorMap(), 9);
  drive(localizer, world, 20.0, 20.0);
  const PoseEstimate before = localizer.latest();
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = before.stamp_us + 50'000;
  const Pose2 moved{0.02, 0.001, 0.01};
  snapshot->T_odom_robot = before.T_odom_robot * moved;
  snapshot->epoch = 0;
  const PoseEstimate after = localizer.update({snapshot, std::make_shared<ImageAnalysis>()});
  const Pose2 expected = *before.T_world_robot * moved;
  EXPECT_NEAR(after.T_world_robot->x, expected.x, 1e-9);
  EXPECT_NEAR(after.T_world_robot->y, expected.y, 1e-9);
  EXPECT_NEAR(angleDifference(after.T_world_robot->theta, expected.theta), 0.0, 1e-9);
}

TEST_P(InBothModes, OnlyTheDefaultModeCalibratesOdometry) {
  CorridorWorld world({}, 9);
  Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 9);
  drive(localizer, world, 20.0, 20.0);
  const auto& calibrated = localizer.latest().odometry;
  ASSERT_EQ(calibrated.has_value(), GetParam() == LocalizationMode::kDefault);
  if (calibrated) {
    EXPECT_LT(std::sqrt(calibrated->P(0, 0)), 0.7 * RaceFilterParams{}.odometry_bias[0]);
  }
}

TEST_P(InBothModes, ANewEpochKeepsTheRacesButNotTheReliability) {
  CorridorWorld world({}, 10);
  Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 10);
  drive(localizer, world, 30.0, 30.0);
  const PoseEstimate before = localizer.latest();
  ASSERT_GT(before.reliability, 0.6);
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = before.stamp_us + 50'000;
  snapshot->T_odom_robot = before.T_odom_robot;
  snapshot->epoch = 1;
  const PoseEstimate after = localizer.update({snapshot, std::make_shared<ImageAnalysis>()});
  EXPECT_EQ(after.races.size(), before.races.size());
  EXPECT_LE(after.reliability, 0.1);
}

// The updates after another component was killed or frozen.
TEST_P(InBothModes, SurvivesRestartsOfBaseMemoryAndTime) {
  struct Case {
    const char* what;
    StampUs after_us;
    std::uint64_t revisions;  ///< added to the last one; 0: counted anew from 1
    std::uint32_t epochs;
    Pose2 T_odom_robot;
    bool moves;  ///< the races move on by odometry
  };
  CorridorWorld world({}, 10);
  Localizer settled(withoutCalibration(paramsOf(GetParam())), test::corridorMap(), 10);
  for (int i = 0; i < 600; ++i) settled.update(world.next());
  const PoseEstimate before = settled.latest();
  ASSERT_GT(before.reliability, 0.6);
  const std::uint64_t revision = 600;
  const Pose2 ahead = before.T_odom_robot * Pose2{0.3, 0.0, 0.0};
  const std::vector<Case> cases{
      {"base restarted: its odometry begins at its origin, after a pause", 5 * kSecondUs, 1, 1, {}, false},
      {"memory restarted while the robot moved on", 2 * kSecondUs, 0, 0, ahead, true},
      {"simulator restarted: time and odometry from zero", 100'000 - before.stamp_us, 1, 1, {}, false},
      {"nothing: a pause", 2 * kSecondUs, 1, 0, ahead, true},
  };
  for (const Case& fault : cases) {
    CorridorWorld same_world({}, 10);
    Localizer localizer(withoutCalibration(paramsOf(GetParam())), test::corridorMap(), 10);
    for (int i = 0; i < 600; ++i) localizer.update(same_world.next());
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = before.stamp_us + fault.after_us;
    snapshot->T_odom_robot = fault.T_odom_robot;
    snapshot->epoch = fault.epochs;
    snapshot->revision = fault.revisions == 0 ? 1 : revision + fault.revisions;
    const PoseEstimate after = localizer.update({snapshot, std::make_shared<ImageAnalysis>()});
    ASSERT_TRUE(after.T_world_robot) << fault.what;
    EXPECT_EQ(after.races.size(), before.races.size()) << fault.what;
    const double moved_m = (after.T_world_robot->position() - before.T_world_robot->position()).norm();
    EXPECT_NEAR(moved_m, fault.moves ? 0.3 : 0.0, 1e-6) << fault.what;
    if (fault.epochs > 0 || fault.revisions == 0) {
      EXPECT_LE(after.reliability, 0.1) << fault.what;
    } else {
      EXPECT_GT(after.reliability, 0.5) << fault.what;
    }
  }
}

TEST_P(InBothModes, AnEmptyMemoryLeavesTheRacesUnchanged) {
  CorridorWorld world({}, 10);
  Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 10);
  drive(localizer, world, 20.0, 20.0);
  const PoseEstimate before = localizer.latest();
  for (int i = 1; i <= 20; ++i) {
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = before.stamp_us + i * 200'000;
    snapshot->T_odom_robot = before.T_odom_robot;
    const PoseEstimate after = localizer.update({snapshot, std::make_shared<ImageAnalysis>()});
    ASSERT_EQ(after.races.size(), before.races.size());
    EXPECT_NEAR(after.T_world_robot->x, before.T_world_robot->x, 1e-9);
  }
}

TEST_P(InBothModes, SetPoseReplacesAllRacesAndRelocalizeDeletesThem) {
  CorridorWorld world({}, 11);
  Localizer localizer(paramsOf(GetParam()), test::corridorMap(), 11);
  for (int i = 0; i < 60; ++i) localizer.update(world.next());
  const std::uint64_t revision = localizer.latest().revision;
  localizer.setPose(world.truth());
  EXPECT_GT(localizer.latest().revision, revision);  // published at once, without an update
  EXPECT_NEAR(positionError(localizer.latest(), world.truth()), 0.0, 1e-12);
  for (int i = 0; i < 100; ++i) {
    const PoseEstimate estimate = localizer.update(world.next());
    ASSERT_TRUE(estimate.T_world_robot);
    EXPECT_LT(positionError(estimate, world.truth()), 0.3) << i;
  }
  localizer.relocalize();
  EXPECT_TRUE(localizer.latest().races.empty());
  EXPECT_FALSE(localizer.latest().T_world_robot);
  EXPECT_EQ(localizer.latest().reliability, 0.0);
}

TEST(Localizer, AGivenPoseHasTheReliabilityOfTheLastObservation) {
  CorridorWorld world({}, 11);
  Localizer localizer(paramsOf(LocalizationMode::kDefault), test::corridorMap(), 11);
  for (int i = 0; i < 60; ++i) localizer.update(world.next());
  localizer.setPose(world.truth());
  EXPECT_GT(localizer.latest().reliability, 0.6);
  localizer.setPose({3.0, 2.5, 1.0});  // inside the block
  EXPECT_LT(localizer.latest().reliability, 0.3);
}

/// L2: odometry first, then the observation. The robot jumps by 0.4 m between two updates, as odometry
/// reports.
TEST_P(InBothModes, AnIterationPredictsByOdometryBeforeItWeighs) {
  CorridorWorld world({}, 13);
  Localizer localizer(withoutCalibration(paramsOf(GetParam())), test::corridorMap(), 13);
  for (int i = 0; i < 60; ++i) localizer.update(world.next());
  localizer.setPose(world.truth());
  for (int i = 0; i < 10; ++i) localizer.update(world.next());
  // The memory stays in the world; the robot and its odometry are 0.4 m further, one tick later.
  const MemoryUpdate last = world.next();
  localizer.update(last);
  const Pose2 before = *localizer.latest().T_world_robot;
  const double health_before = localizer.table().winner()->health;
  auto snapshot = std::make_shared<MemorySnapshot>(*last.snapshot);
  const Pose2 moved{0.4, 0.0, 0.0};
  snapshot->stamp_us += kSecondUs / 5;
  snapshot->T_odom_robot = snapshot->T_odom_robot * moved;
  for (MemorySegment& segment : snapshot->segments) segment.last_seen_us += kSecondUs / 5;
  localizer.update({snapshot, std::make_shared<ImageAnalysis>()});
  const Pose2 expected = before * moved;
  ASSERT_TRUE(localizer.table().winner());
  EXPECT_LT((localizer.latest().T_world_robot->position() - expected.position()).norm(), 0.1);
  // Weighed at the old pose, the observation would contradict by 0.4 m.
  EXPECT_GT(localizer.table().winner()->health, health_before - 0.2);
}

TEST(Localizer, IteratesOncePerTickOfStamps) {
  CorridorWorld world({}, 14);
  Localizer localizer(paramsOf(LocalizationMode::kDefault), test::corridorMap(), 14);
  for (int i = 0; i < 50; ++i) localizer.update(world.next());
  localizer.setPose(world.truth());
  const auto age = [&] { return localizer.table().winner()->age; };
  ASSERT_TRUE(localizer.table().winner());
  const std::uint64_t id = localizer.table().winner()->id;
  const int before = age();
  // 10 Hz for 4 s at a tick of 0.2 s: 20 iterations; candidates at its place may age a race further.
  for (int i = 0; i < 40; ++i) localizer.update(world.next());
  ASSERT_EQ(localizer.table().winner()->id, id);
  EXPECT_GE(age() - before, 19);
  EXPECT_EQ(localizer.latest().revision, 91u) << "one estimate per update, and one for the given pose";
}

TEST(Localizer, AnUpdateIsNotUsedTwice) {
  CorridorWorld world({}, 12);
  Localizer localizer(paramsOf(LocalizationMode::kDefault), test::corridorMap(), 12);
  const MemoryUpdate update = world.next();
  const PoseEstimate first = localizer.update(update);
  EXPECT_EQ(localizer.update(update).revision, first.revision);
}

}  // namespace
}  // namespace vismem
