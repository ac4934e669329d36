// A place that is thought of only now is asked about what was seen before (DESIGN 9 part 4).
#include "localization/core/past_observations.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vismem {
namespace {

MapSegment edge(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

/// Two corners alike, 20 m apart, of which the second has a door; and a nook unlike both.
SegmentMap twinCorners() {
  SegmentMap map;
  map.segments = {edge(0, 0, 3, 0),
                  edge(0, 0, 0, 3),
                  edge(20, 0, 23, 0),
                  edge(20, 0, 20, 3),
                  edge(21, 2, 22, 2, "door_foot"),
                  edge(40, 0, 41, 1),
                  edge(41, 1, 42, 0)};
  return map;
}

class APlaceThoughtOfNow : public testing::Test {
 protected:
  APlaceThoughtOfNow()
      : local_(localizerPreset(LocalizationMode::kDefault)),
        map_(edges_, robustIndex(local_)),
        likelihood_(map_, local_.robust),
        past_(likelihood_, local_.robust) {
    winner_.id = 1;
    winner_.T_world_robot = kFirst;
    winner_.evidence = -5.0;
  }

  RobustObservation seenFrom(const Pose2& from, const std::vector<std::size_t>& segments) const {
    RobustObservation seen;
    for (const std::size_t i : segments) {
      const MapSegment& one = edges_.segments[i];
      const Segment2 robot = transform(inverse(from), one.world.floor());
      for (int k = 0; k < 10; ++k) {
        EvidencePoint point;
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
  /// One iteration: the robot, standing still by its odometry, sees segments of the map as from a place.
  void see(const Pose2& from, const std::vector<std::size_t>& segments) {
    past_.begin(seenFrom(from, segments), {});
    past_.note(winner_);
  }
  void seeCorner(int iterations) {
    for (int i = 0; i < iterations; ++i) see(kFirst, {0, 1});
  }
  Race earned(const Pose2& place, double log_likelihood = 0.0) {
    Race race;
    race.T_world_robot = place;
    race.log_likelihood = log_likelihood;
    past_.earn(race, std::span(&winner_, 1));
    return race;
  }

  static constexpr Pose2 kFirst{1.0, 1.0, 0.3};
  static constexpr Pose2 kTwin{21.0, 1.0, 0.3};
  static constexpr Pose2 kNook{41.0, -0.5, 0.3};
  const SegmentMap edges_ = twinCorners();
  LocalizerParams local_;
  MapIndex map_;
  RobustLikelihood likelihood_;
  PastObservations past_;
  Race winner_;
};

TEST_F(APlaceThoughtOfNow, NewsThatAreWeighedAgainCountAsIfTheyHadBeenSoAtOnce) {
  PastObservations at_once(likelihood_, local_.robust);
  const auto bothSee = [&](const RobustObservation& seen) {
    past_.begin(seen, {});
    at_once.begin(seen, {});
  };
  for (int i = 0; i < 5; ++i) {
    bothSee(seenFrom(kFirst, {0, 1}));
    past_.note(winner_);
  }
  const RobustObservation fresh = seenFrom(kFirst, {0, 1});
  RobustObservation repeated = fresh;
  repeated.news = 0.2;
  past_.begin(repeated, {});
  at_once.begin(fresh, {});
  EXPECT_NEAR(past_.newest(), 0.2 * at_once.newest(), 1e-12);
  past_.weighAgain(fresh);
  EXPECT_DOUBLE_EQ(past_.newest(), at_once.newest());
  bothSee(fresh);
  Race weighed_again = earned(kTwin);
  Race new_at_once;
  new_at_once.T_world_robot = kTwin;
  at_once.earn(new_at_once, std::span(&winner_, 1));
  EXPECT_DOUBLE_EQ(weighed_again.evidence, new_at_once.evidence);
}

TEST_F(APlaceThoughtOfNow, IsLevelWithTheWinnerIfItExplainsThePastAsWell) {
  seeCorner(40);
  EXPECT_NEAR(earned(kTwin).evidence, winner_.evidence, 1e-6);
}

TEST_F(APlaceThoughtOfNow, DoesNotWinBecauseOfWhatOneImageShows) {
  seeCorner(40);
  // Something false that looks like the twin's door, for as long as it takes to be asked about.
  see(kTwin, {2, 3, 4});
  see(kTwin, {2, 3, 4});
  ASSERT_LT(winner_.past.front(), -20.0) << "the winner does not explain it";
  EXPECT_LT(earned(kTwin).evidence, winner_.evidence + 0.2 * local_.robust.lead);
}

TEST_F(APlaceThoughtOfNow, PaysForTheJumpThatItSupposesIfItExplainsNothingOfThePast) {
  seeCorner(40);
  EXPECT_NEAR(earned(kNook).evidence, winner_.evidence - local_.robust.birth_penalty, 1e-6);
}

TEST_F(APlaceThoughtOfNow, IsGivenWhatItExplainedBetterSinceTheJump) {
  seeCorner(40);
  winner_.evidence = -5.0;
  for (int i = 0; i < 8; ++i) see(kNook, {5, 6});
  const Race found = earned(kNook);
  // Seven of the eight are past; the winner explains none of their 20 points, the newcomer all of them.
  const double each = -20.0 * std::log(local_.robust.outlier_share);
  EXPECT_GT(found.evidence, winner_.evidence - local_.robust.birth_penalty + 0.25 * each);
  EXPECT_LT(found.evidence, winner_.evidence - local_.robust.birth_penalty + 0.45 * each);
  ASSERT_GT(found.past.size(), 8u);
  EXPECT_NEAR(found.past[6], 0.0, 0.1) << "since then it is its own story";
  EXPECT_NEAR(found.past[8], winner_.past[8], 1e-9) << "before it was the winner's";
}

TEST_F(APlaceThoughtOfNow, OwesNothingToAnybodyWhereThereAreNoRaces) {
  seeCorner(12);
  Race race;
  race.T_world_robot = kNook;
  past_.earn(race, {});
  EXPECT_NEAR(race.evidence, 20.0 * std::log(local_.robust.outlier_share), 0.5);
  race.T_world_robot = kTwin;
  past_.earn(race, {});
  EXPECT_NEAR(race.evidence, 0.0, 0.1);
}

TEST_F(APlaceThoughtOfNow, IsNotAskedAboutWhatWasForgotten) {
  seeCorner(40);
  past_.clear(true);
  winner_.past.clear();
  see(kNook, {5, 6});
  EXPECT_NEAR(earned(kNook).evidence, winner_.evidence - local_.robust.birth_penalty, 1e-9);
}

TEST_F(APlaceThoughtOfNow, MeetsADefendedWinnerWhereThePlaceWasToldAndNoneAtAnUnknownStart) {
  past_.clear(true);
  see(kNook, {5, 6});
  EXPECT_NEAR(past_.newest(), 1.0 - local_.robust.forgetting, 1e-6) << "one image against what was told";
  past_.clear(false);
  see(kNook, {5, 6});
  EXPECT_NEAR(past_.newest(), 1.0, 1e-9) << "nothing is known but this image";
  see(kNook, {5, 6});
  EXPECT_NEAR(past_.newest(), 1.0 / (1.0 + local_.robust.forgetting), 1e-9) << "both count nearly alike";
}

TEST_F(APlaceThoughtOfNow, FollowsOdometryIntoThePast) {
  // The robot drives 1 m along x in the corner; what it saw before was seen from there.
  for (int i = 0; i <= 20; ++i) {
    const Pose2 odom{0.05 * i, 0.0, 0.0};
    const Pose2 place = Pose2{1.0, 1.0, 0.0} * odom;
    RobustObservation seen;
    for (int k = 0; k < 20; ++k) {
      EvidencePoint point;
      const Eigen::Vector2d world =
          k < 10 ? Eigen::Vector2d(0.2 * k, 0.0) : Eigen::Vector2d(0.0, 0.2 * (k - 9));
      point.p_robot = world - place.position();
      point.direction_robot = k < 10 ? 0.0 : M_PI / 2;
      point.label = *map_.floorLabelId("skirting");
      point.sigma_m = 0.03;
      point.weight = 1.0;
      seen.points.push_back(point);
    }
    past_.begin(seen, odom);
  }
  Race race;
  race.T_world_robot = {2.0, 1.0, 0.0};
  past_.earn(race, {});
  ASSERT_GE(race.past.size(), 20u);
  EXPECT_NEAR(race.past.back(), 0.0, 0.01);
  race.T_world_robot = {1.0, 1.0, 0.0};  // where it was at first: 1 m off now
  past_.earn(race, {});
  EXPECT_LT(race.past.back(), -20.0);
}

}  // namespace
}  // namespace vismem
