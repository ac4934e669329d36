// Tests L2, L6, L8, L12, B2.
#include "localization/core/hypotheses/robust_races.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace vismem {
namespace {

SegmentMap oneWall() {
  SegmentMap map;
  map.segments = {{{{0, 0, 0}, {3, 0, 0}}, "skirting", 0.0}};
  return map;
}

/// Shares of two races whose mean evidence differs by half a nat.
std::array<double, 2> sharesWith(double forgetting) {
  RobustParams params;
  params.evidence.independent_share = 0.15;
  params.history.forgetting = forgetting;
  const auto strategy = makeRobustRaces(oneWall(), {}, {}, params);
  RaceTable table{RaceParams{}};
  for (int i = 0; i < 2; ++i) {
    Race race;
    race.T_world_robot = {i * 5.0, 0.0, 0.0};
    race.health = 0.9;
    race.evidence = -1.0 - 0.5 * i;
    table.admit(race);
  }
  return {strategy->beliefShare(*table.find(1), table), strategy->beliefShare(*table.find(2), table)};
}

TEST(BeliefShares, CountTheIndependentObservationsInTheMean) {
  // 20 observations with 3 independent ones among them: exp(-3 * 0.5).
  const std::array<double, 2> shares = sharesWith(0.95);
  EXPECT_NEAR(shares[0] + shares[1], 1.0, 1e-12);
  EXPECT_NEAR(shares[1] / shares[0], std::exp(-1.5), 1e-9);
}

TEST(BeliefShares, OneObservationCountsOnce) {
  const std::array<double, 2> shares = sharesWith(0.0);
  EXPECT_NEAR(shares[1] / shares[0], std::exp(-0.5), 1e-9);
}

/// Two walls at a right angle, and a memory of both.
class RobustRacesTest : public testing::Test {
 protected:
  RobustRacesTest() {
    map_.segments = {{{{0, 0, 0}, {4, 0, 0}}, "skirting", 0.0}, {{{0, 0, 0}, {0, 4, 0}}, "skirting", 0.0}};
    races_ = makeRobustRaces(map_, {}, {}, params_);
  }
  void observeFrom(const Pose2& T_world_robot) {
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = kSecondUs;
    for (const MapSegment& one : map_.segments) {
      MemorySegment segment;
      const Segment2 odom = transform(inverse(T_world_robot), one.world.floor());
      segment.odom = {{odom.a.x(), odom.a.y(), 0.0}, {odom.b.x(), odom.b.y(), 0.0}};
      segment.label = one.label;
      segment.confirmed = true;
      segment.last_seen_us = kSecondUs;
      snapshot->segments.push_back(segment);
    }
    ASSERT_TRUE(races_->observe({snapshot, nullptr}));
  }
  /// A table with a winner (evidence 0) and a rival of an age.
  static RaceTable tableWith(double rival_evidence, int rival_age) {
    RaceTable table{RaceParams{}};
    for (int i = 0; i < 2; ++i) {
      Race race;
      race.T_world_robot = {5.0 * i, 0.0, 0.0};
      race.health = 0.9;
      race.evidence = i * rival_evidence;
      race.age = i == 0 ? 100 : rival_age;
      table.admit(race);
    }
    table.setWinner(1);
    return table;
  }
  std::uint64_t winnerWith(double rival_evidence, int rival_age) const {
    RaceTable table = tableWith(rival_evidence, rival_age);
    races_->select(table, 0.5);
    return table.winner()->id;
  }

  SegmentMap map_;
  RobustParams params_;
  std::unique_ptr<RaceStrategy> races_;
};

TEST_F(RobustRacesTest, PredictionAddsOdometryNoiseInTheRobotsFrame) {
  Race race;
  race.T_world_robot = {1.0, 1.0, 0.0};
  race.P = Matrix5d::Zero();
  race.P(2, 2) = 0.04;
  race.P_reported = race.P;
  races_->predict(race, {2.0, 0.0, 0.1});
  EXPECT_EQ(race.T_world_robot, (Pose2{3.0, 1.0, 0.1}));
  // 2 m at 4 % is 0.08 m; a heading variance of 0.04 over 2 m adds 4 * 0.04 across.
  EXPECT_NEAR(race.P(0, 0), 0.08 * 0.08, 1e-12);
  EXPECT_NEAR(race.P(1, 1), 0.16 + 0.08 * 0.08, 1e-12);
  EXPECT_NEAR(race.P(1, 2), 2.0 * 0.04, 1e-12);
  // 0.10 rad/rad * 0.1 rad + 0.10 rad/m * 2 m = 0.21 rad.
  EXPECT_NEAR(race.P(2, 2), 0.04 + 0.21 * 0.21, 1e-12);
  EXPECT_EQ(race.P_reported, race.P);
}

TEST_F(RobustRacesTest, ARaceEstimatesTheLastingErrorsOfOdometry) {
  // Odometry reports too little by: yaw bias [rad/m], yaw scale, distance scale.
  const auto drive = [&](const Eigen::Vector3d& errors) {
    RandomEngine engine(1);
    Pose2 truth{3.2, 1.2, 0.9};
    observeFrom(truth);
    Race race = races_->createAt(truth, engine);
    race.P = race.P_reported = 1e-4 * Matrix5d::Identity();
    // Round and round, now to the left and now to the right, so that both errors of the yaw show.
    for (int i = 0; i < 120; ++i) {
      const Pose2 reported{0.1, 0.0, i / 30 % 2 == 0 ? 0.2 : -0.2};
      truth = truth * Pose2{(1.0 + errors[2]) * reported.x, 0.0,
                            (1.0 + errors[1]) * reported.theta + errors[0] * reported.x};
      observeFrom(truth);
      races_->predict(race, reported);
      races_->refine(race, engine);
    }
    EXPECT_LT((race.T_world_robot.position() - truth.position()).norm(), 0.02) << errors.transpose();
    return race;
  };
  for (const Eigen::Vector3d& errors :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.06, 0, 0), Eigen::Vector3d(0, -0.05, 0),
        Eigen::Vector3d(0, 0, 0.2), Eigen::Vector3d(-0.05, 0.04, -0.1)}) {
    const Race race = drive(errors);
    const Eigen::Vector3d std = race.odometry.P.diagonal().cwiseSqrt();
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(race.odometry.errors[i], errors[i], 3.0 * std[i]) << errors.transpose() << ", " << i;
      EXPECT_LT(std[i], 0.7 * params_.filter.odometry_bias[i]) << i;
    }
  }
}

TEST_F(RobustRacesTest, ANewRaceBeginsWithTheWinnersErrorsOfOdometry) {
  const Pose2 truth{1.5, 1.2, 0.4};
  observeFrom(truth);
  RandomEngine engine(1);
  RaceTable table{RaceParams{}};
  table.replaceAll(races_->createAt(truth, engine));
  table.races().front().odometry.errors = {0.01, 0.02, 0.03};
  races_->select(table, 1.0);
  EXPECT_EQ(races_->createAt({3.0, 3.0, 0.0}, engine).odometry.errors, Eigen::Vector3d(0.01, 0.02, 0.03));
}

TEST_F(RobustRacesTest, RefinementMovesARaceToTheTruePoseAndReducesItsCovariance) {
  const Pose2 truth{1.5, 1.2, 0.4};
  observeFrom(truth);
  RandomEngine engine(1);
  Race race = races_->createAt(truth * Pose2{0.05, -0.04, 0.05}, engine);
  race.P.topLeftCorner<3, 3>() = 0.01 * Eigen::Matrix3d::Identity();
  const auto trace = [&race] { return race.P(0, 0) + race.P(1, 1) + race.P(2, 2); };
  const double before = trace();
  for (int i = 0; i < 5; ++i) races_->refine(race, engine);
  EXPECT_LT((race.T_world_robot.position() - truth.position()).norm(), 0.01);
  EXPECT_NEAR(race.T_world_robot.theta, truth.theta, 0.01);
  EXPECT_LT(trace(), before);
  EXPECT_GT(race.health, 0.9);
  EXPECT_TRUE(race.P_reported.isApprox(race.P_reported.transpose()));
}

TEST_F(RobustRacesTest, ANewRaceNeedsTheFullLeadAnOldOneAThird) {
  // Lead 1.5 nats; at age 0 all of it, at a large age 0.33 of it.
  EXPECT_EQ(winnerWith(1.45, 0), 1u);
  EXPECT_EQ(winnerWith(1.55, 0), 2u);
  EXPECT_EQ(winnerWith(0.45, 1000), 1u);
  EXPECT_EQ(winnerWith(0.55, 1000), 2u);
}

// A tilted camera is unlikely before calibration has learnt it; a race pays for it once.
TEST_F(RobustRacesTest, ATiltIsPaidOnceAlsoWhereTheMemoryBeginsAnew) {
  RaceTable table = tableWith(-4.0, 10);
  const double upright = races_->beliefShare(*table.find(1), table);
  table.races()[0].camera_tilt = {degToRad(1.0), 0.0};
  const double tilted = races_->beliefShare(*table.find(1), table);
  EXPECT_LT(tilted, upright);
  EXPECT_GT(tilted, 0.9);
  races_->discountEvidence(table);
  // One nat counts as three independent observations: what is left of the lead.
  EXPECT_NEAR(races_->beliefShare(*table.find(1), table), 1.0 / (1.0 + std::exp(-3.0)), 1e-9);
}

TEST_F(RobustRacesTest, OneBadImagePrunesOnlyARaceThatIsFarBehind) {
  const auto isKept = [&](double evidence, double health) {
    RaceTable table = tableWith(evidence, 10);
    table.races()[1].health = health;
    table.prune(races_->sparedEvidence(table));
    return table.find(1) && table.find(2);
  };
  EXPECT_TRUE(isKept(-1.4, 0.1));
  EXPECT_FALSE(isKept(-1.6, 0.1));
  EXPECT_TRUE(isKept(-1.6, 0.9));
}

TEST_F(RobustRacesTest, ProposalsIncludeTheTruePose) {
  const Pose2 truth{1.5, 1.2, 0.4};
  observeFrom(truth);
  RandomEngine engine(2);
  const auto proposed = races_->propose(500, RaceTable{RaceParams{}}, engine);
  ASSERT_FALSE(proposed.empty());
  EXPECT_TRUE(std::any_of(proposed.begin(), proposed.end(), [&](const Race& race) {
    return samePlace(race.T_world_robot, truth, {}) && race.health > 0.9;
  }));
}

TEST_F(RobustRacesTest, ReliabilityFollowsItsTargetWithItsTimeConstant) {
  const Pose2 truth{1.5, 1.2, 0.4};
  observeFrom(truth);
  RandomEngine engine(3);
  RaceTable table{RaceParams{}};
  table.replaceAll(races_->createAt(truth, engine));
  // A full explanation of enough points by the only race: the target is 1.
  EXPECT_NEAR(*races_->agreement(table), 1.0, 1e-9);
  EXPECT_NEAR(races_->updatedSupport(0.2, table, 2.0), 0.2 + (1.0 - std::exp(-1.0)) * 0.8, 1e-9);
  EXPECT_TRUE(races_->isUnambiguous(table));
}

TEST_F(RobustRacesTest, DiscountedEvidenceIsAtMostOneNatBehindTheBest) {
  RaceTable table = tableWith(-5.0, 10);
  for (Race& race : table.races()) race.victories = 7;
  races_->discountEvidence(table);
  EXPECT_DOUBLE_EQ(table.find(1)->evidence, 0.0);
  EXPECT_DOUBLE_EQ(table.find(2)->evidence, -1.0);
  EXPECT_EQ(table.find(1)->victories, 1);
}

}  // namespace
}  // namespace vismem
