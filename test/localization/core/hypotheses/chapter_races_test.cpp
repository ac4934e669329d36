// Tests L2, L6, L8, L9.
#include "localization/core/hypotheses/chapter_races.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2) {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, "skirting", 0.0};
}

/// Two walls at a right angle, and a memory of both.
class ChapterRacesTest : public testing::Test {
 protected:
  ChapterRacesTest() {
    map_.segments = {wall(0, 0, 4, 0), wall(0, 0, 0, 4)};
    params_.health.source = ObservationSource::kMemory;
    races_ = makeChapterRaces(map_, params_);
  }
  /// What a robot at a pose remembers of both walls.
  void observeFrom(const Pose2& T_world_robot) {
    auto snapshot = std::make_shared<MemorySnapshot>();
    for (const MapSegment& one : map_.segments) {
      MemorySegment segment;
      const Segment2 odom = transform(inverse(T_world_robot), one.world.floor());
      segment.odom = {{odom.a.x(), odom.a.y(), 0.0}, {odom.b.x(), odom.b.y(), 0.0}};
      segment.label = one.label;
      snapshot->segments.push_back(segment);
    }
    ASSERT_TRUE(races_->observe({snapshot, nullptr}));
  }
  /// A table with a winner of health 0.5 and a rival ahead by `lead`.
  RaceTable tableWithLead(double lead) const {
    RaceParams params;
    params.create_health = 0.0;
    RaceTable table(params);
    for (int i = 0; i < 2; ++i) {
      Race race;
      race.T_world_robot = {2.0 * i, 0.0, 0.0};
      race.health = 0.5 + i * lead;
      table.admit(race);
    }
    table.setWinner(1);
    return table;
  }
  /// True if the rival gains the victory at this lead.
  bool gains(double lead, double reliability) const {
    RaceTable table = tableWithLead(lead);
    races_->select(table, reliability);
    return table.find(2)->victories == 1;
  }

  SegmentMap map_;
  ChapterParams params_;
  std::unique_ptr<RaceStrategy> races_;
};

TEST_F(ChapterRacesTest, TheLeadGrowsWithReliability) {
  // 0.01 + 0.09 * reliability, and 0.1 above 0.8.
  EXPECT_FALSE(gains(0.009, 0.0));
  EXPECT_TRUE(gains(0.011, 0.0));
  EXPECT_FALSE(gains(0.054, 0.5));
  EXPECT_TRUE(gains(0.056, 0.5));
  EXPECT_FALSE(gains(0.081, 0.8));
  EXPECT_TRUE(gains(0.083, 0.8));
  EXPECT_FALSE(gains(0.099, 0.81));
  EXPECT_TRUE(gains(0.101, 0.81));
}

TEST_F(ChapterRacesTest, PredictionMovesTheRaceAndAllItsIndividuals) {
  Race race;
  race.T_world_robot = {1.0, 1.0, degToRad(90)};
  race.individuals = {{{1.0, 1.0, degToRad(90)}}, {{2.0, 0.0, 0.0}}};
  races_->predict(race, {0.5, 0.0, 0.1});
  EXPECT_NEAR(race.T_world_robot.y, 1.5, 1e-12);
  EXPECT_NEAR(race.individuals[0].T_world_robot.y, 1.5, 1e-12);
  EXPECT_NEAR(race.individuals[1].T_world_robot.x, 2.5, 1e-12);
  EXPECT_NEAR(race.individuals[1].T_world_robot.theta, 0.1, 1e-12);
}

TEST_F(ChapterRacesTest, ARaceAtTheTruePoseHasTheHigherHealth) {
  const Pose2 truth{1.5, 1.5, 0.3};
  observeFrom(truth);
  RandomEngine engine(1);
  const Race right = races_->createAt(truth, engine);
  const Race wrong = races_->createAt(truth * Pose2{0.6, 0.4, 0.5}, engine);
  EXPECT_GT(right.health, 0.6);
  EXPECT_LT(wrong.health, right.health - 0.3);
  EXPECT_EQ(right.T_world_robot, truth) << "a given pose is kept";
  EXPECT_EQ(right.individuals.size(), 30u);
}

TEST_F(ChapterRacesTest, EvolutionRaisesTheHealthOfARaceNearTheTruePose) {
  const Pose2 truth{1.5, 1.5, 0.3};
  observeFrom(truth);
  RandomEngine engine(2);
  Race race = races_->createAt(truth * Pose2{0.1, -0.1, 0.1}, engine);
  const double before = race.health;
  for (int i = 0; i < 15; ++i) races_->refine(race, engine);
  EXPECT_GT(race.health, before);
  EXPECT_GT(race.health, 0.8);
  EXPECT_LT((race.T_world_robot.position() - truth.position()).norm(), 0.1);
}

TEST_F(ChapterRacesTest, ProposedRacesLieAtDifferentPlacesBestFirst) {
  observeFrom({1.5, 1.5, 0.3});
  RandomEngine engine(3);
  const auto proposed = races_->propose(20'000, RaceTable{RaceParams{}}, engine);
  ASSERT_GT(proposed.size(), 1u);
  EXPECT_LE(proposed.size(), static_cast<std::size_t>(params_.explorers.candidates));
  for (std::size_t i = 0; i < proposed.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_FALSE(samePlace(proposed[i].individuals.front().T_world_robot,
                             proposed[k].individuals.front().T_world_robot, {}));
    }
  }
}

TEST_F(ChapterRacesTest, ReliabilityRisesAboveHealth08AndFallsBelow07) {
  observeFrom({1.5, 1.5, 0.3});
  const auto after = [&](double health) {
    RaceParams params;
    params.create_health = 0.0;
    RaceTable table(params);
    Race race;
    race.health = health;
    table.replaceAll(race);
    return races_->updatedSupport(0.5, table, 0.2);
  };
  // Two lines are few: at most 0.03 down per iteration, and not up.
  EXPECT_EQ(after(1.0), 0.5);
  EXPECT_EQ(after(0.75), 0.5);
  EXPECT_NEAR(after(0.0), 0.5 - 0.03, 1e-12);
  EXPECT_EQ(races_->updatedSupport(0.5, RaceTable{RaceParams{}}, 0.2), 0.0) << "no winner";
}

}  // namespace
}  // namespace vismem
