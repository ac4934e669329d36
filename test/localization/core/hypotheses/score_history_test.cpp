// Tests L12.
#include "localization/core/hypotheses/score_history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "localization/core/hypotheses/race.h"

namespace vismem {
namespace {

MapSegment edge(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

/// Two equal corners 20 m apart, the second with a door, and two equal nooks unlike both.
SegmentMap twinCorners() {
  SegmentMap map;
  map.segments = {edge(0, 0, 3, 0),
                  edge(0, 0, 0, 3),
                  edge(20, 0, 23, 0),
                  edge(20, 0, 20, 3),
                  edge(21, 2, 22, 2, "door_foot"),
                  edge(40, 0, 41, 1),
                  edge(41, 1, 42, 0),
                  edge(60, 0, 61, 1),
                  edge(61, 1, 62, 0)};
  return map;
}

class ScoreHistoryTest : public testing::Test {
 protected:
  ScoreHistoryTest()
      : map_(edges_, robustIndex(likelihood_params_, {})),
        likelihood_(map_, likelihood_params_),
        history_(likelihood_, params_) {}

  FloorObservation seenFrom(const Pose2& from, const std::vector<std::size_t>& segments) const {
    FloorObservation seen;
    for (const std::size_t i : segments) {
      const MapSegment& one = edges_.segments[i];
      const Segment2 robot = transform(inverse(from), one.world.floor());
      for (int k = 0; k < 10; ++k) {
        FloorPoint point;
        point.p_robot = robot.a + (k + 0.5) / 10.0 * (robot.b - robot.a);
        point.direction_robot = robot.direction();
        point.label = *map_.floorLabelId(one.label);
        point.sigma_m = 0.03;
        point.weight = 1.0;
        seen.points.push_back(point);
      }
    }
    return seen;
  }
  /// One iteration of a standing robot: an observation of map segments from a pose.
  void see(const Pose2& from, const std::vector<std::size_t>& segments) {
    history_.begin(seenFrom(from, segments), {}, novelty_);
    history_.record(winner_);
  }
  void seeCorner(int iterations) {
    for (int i = 0; i < iterations; ++i) see(kFirst, {0, 1});
  }
  InitialEvidence initialAt(const Pose2& place) const { return initialAt(place, history_); }
  InitialEvidence initialAt(const Pose2& place, const ScoreHistory& history) const {
    return history.initialEvidence(place, 0.0, std::span(&winner_, 1));
  }

  static constexpr double kLead = 1.5;  // EvidenceParams::lead
  static constexpr Pose2 kFirst{1.0, 1.0, 0.3};
  static constexpr Pose2 kTwin{21.0, 1.0, 0.3};
  static constexpr Pose2 kNook{41.0, -0.5, 0.3};
  static constexpr Pose2 kOtherNook{61.0, -0.5, 0.3};
  const SegmentMap edges_ = twinCorners();
  const LikelihoodParams likelihood_params_;
  const ScoreHistoryParams params_;
  MapIndex map_;
  RobustLikelihood likelihood_;
  ScoreHistory history_;
  Race winner_ = [] {  // stays at kFirst
    Race race;
    race.T_world_robot = kFirst;
    race.evidence = -5.0;
    return race;
  }();
  double novelty_ = 1.0;  ///< of what see() sees
};

TEST_F(ScoreHistoryTest, APoseThatExplainsThePastAsWellHasTheWinnersEvidence) {
  seeCorner(40);
  EXPECT_NEAR(initialAt(kTwin).evidence, winner_.evidence, 1e-6);
}

TEST_F(ScoreHistoryTest, TheMeanWeightIsThatOfTheObservationsInTheEvidence) {
  see(kFirst, {0, 1});  // 20 points of weight 1
  EXPECT_NEAR(history_.meanWeight(), 20.0, 1e-9);
  see(kFirst, {0});
  EXPECT_NEAR(history_.meanWeight(), 20.0 - 10.0 * history_.newestWeight(), 1e-9);
  const double before = history_.meanWeight();
  novelty_ = 0.0;
  see(kFirst, {0, 1});
  EXPECT_NEAR(history_.meanWeight(), before, 1e-9) << "a repeated view counts nothing";
  history_.clear(false);
  novelty_ = 1.0;
  see(kFirst, {0});
  EXPECT_NEAR(history_.meanWeight(), 10.0, 1e-9);
}

TEST_F(ScoreHistoryTest, OneImageDoesNotMakeAWinner) {
  seeCorner(40);
  // A false observation of the twin's door.
  see(kTwin, {2, 3, 4});
  see(kTwin, {2, 3, 4});
  ASSERT_LT(winner_.scores[0], -20.0) << "the winner does not explain it";
  EXPECT_LT(initialAt(kTwin).evidence, winner_.evidence + 0.2 * kLead);
}

TEST_F(ScoreHistoryTest, APoseThatExplainsNothingOfThePastPaysForTheJump) {
  seeCorner(40);
  EXPECT_NEAR(initialAt(kNook).evidence, winner_.evidence - params_.jump_log_prior, 1e-6);
}

TEST_F(ScoreHistoryTest, TheGainSinceTheJumpIsCredited) {
  seeCorner(40);
  winner_.evidence = -5.0;
  for (int i = 0; i < 8; ++i) see(kNook, {5, 6});
  const InitialEvidence found = initialAt(kNook);
  // Seven of the eight are past; the winner explains none of their 20 points, the new race all of them.
  const double each = -20.0 * std::log(likelihood_params_.outlier_share);
  EXPECT_GT(found.evidence, winner_.evidence - params_.jump_log_prior + 0.25 * each);
  EXPECT_LT(found.evidence, winner_.evidence - params_.jump_log_prior + 0.45 * each);
  ASSERT_GT(found.scores.size(), 8);
  EXPECT_NEAR(found.scores[6], 0.0, 0.1) << "its own scores since the jump";
  EXPECT_NEAR(found.scores[8], winner_.scores[8], 1e-9) << "the winner's scores before";
}

TEST_F(ScoreHistoryTest, APlaceThatExplainsAllSinceARacesJumpHasItsEvidence) {
  seeCorner(40);
  for (int i = 0; i < 8; ++i) see(kNook, {5, 6});
  const InitialEvidence found = initialAt(kNook);
  winner_.T_world_robot = kNook;
  winner_.evidence = found.evidence;
  winner_.scores = found.scores;
  winner_.scores_since_jump = found.scores_since_jump;
  for (int i = 0; i < 3; ++i) see(kNook, {5, 6});
  EXPECT_EQ(winner_.scores_since_jump, 10);
  const InitialEvidence other = initialAt(kOtherNook);
  EXPECT_NEAR(other.evidence, winner_.evidence, 1e-6);
  EXPECT_EQ(other.scores_since_jump, winner_.scores_since_jump);
  // What explains only the time before the jump is a jump of its own.
  EXPECT_NEAR(initialAt(kFirst).evidence, winner_.evidence - params_.jump_log_prior, 1e-6);
}

TEST_F(ScoreHistoryTest, WithoutRacesEvidenceIsTheMeanScore) {
  seeCorner(12);
  EXPECT_NEAR(history_.initialEvidence(kNook, 0.0, {}).evidence,
              20.0 * std::log(likelihood_params_.outlier_share), 0.5);
  EXPECT_NEAR(history_.initialEvidence(kTwin, 0.0, {}).evidence, 0.0, 0.1);
}

TEST_F(ScoreHistoryTest, AClearedHistoryIsNotScored) {
  seeCorner(40);
  history_.clear(true);
  winner_.scores.resize(0);
  see(kNook, {5, 6});
  EXPECT_NEAR(initialAt(kNook).evidence, winner_.evidence - params_.jump_log_prior, 1e-9);
}

TEST_F(ScoreHistoryTest, TheFirstObservationsWeighLittleAfterAGivenPoseAndFullyAtAnUnknownStart) {
  history_.clear(true);
  see(kNook, {5, 6});
  EXPECT_NEAR(history_.newestWeight(), 1.0 - params_.forgetting, 1e-6) << "one image against a given pose";
  history_.clear(false);
  see(kNook, {5, 6});
  EXPECT_NEAR(history_.newestWeight(), 1.0, 1e-9) << "the only observation";
  see(kNook, {5, 6});
  EXPECT_NEAR(history_.newestWeight(), 1.0 / (1.0 + params_.forgetting), 1e-9) << "nearly equal weights";
}

TEST_F(ScoreHistoryTest, ScoresFollowOdometryIntoThePast) {
  // The robot drives 1 m along x in the corner.
  for (int i = 0; i <= 20; ++i) {
    const Pose2 odom{0.05 * i, 0.0, 0.0};
    const Pose2 place = Pose2{1.0, 1.0, 0.0} * odom;
    FloorObservation seen;
    for (int k = 0; k < 20; ++k) {
      FloorPoint point;
      const Eigen::Vector2d world =
          k < 10 ? Eigen::Vector2d(0.2 * k, 0.0) : Eigen::Vector2d(0.0, 0.2 * (k - 9));
      point.p_robot = world - place.position();
      point.direction_robot = k < 10 ? 0.0 : std::numbers::pi / 2;
      point.label = *map_.floorLabelId("skirting");
      point.sigma_m = 0.03;
      point.weight = 1.0;
      seen.points.push_back(point);
    }
    history_.begin(seen, odom, 1.0);
  }
  const InitialEvidence right = history_.initialEvidence({2.0, 1.0, 0.0}, 0.0, {});
  ASSERT_GE(right.scores.size(), 20);
  EXPECT_NEAR(right.scores.tail<1>().value(), 0.0, 0.01);
  // The pose at the start of the drive: 1 m off now.
  EXPECT_LT(history_.initialEvidence({1.0, 1.0, 0.0}, 0.0, {}).scores.tail<1>().value(), -20.0);
}

TEST_F(ScoreHistoryTest, ARobotThatStandsDoesNotForgetWhereItCameFrom) {
  // First with a wall in view that the twin lacks, then a long stop.
  for (int i = 0; i < 10; ++i) see(kFirst, {0, 1, 2});
  const double before = initialAt(kTwin).evidence;
  novelty_ = 0.05;
  seeCorner(200);
  EXPECT_LT(initialAt(kTwin).evidence, winner_.evidence - 0.5 * (winner_.evidence - before));
  novelty_ = 1.0;
  seeCorner(200);
  EXPECT_NEAR(initialAt(kTwin).evidence, winner_.evidence, 1e-6);
}

}  // namespace
}  // namespace vismem
