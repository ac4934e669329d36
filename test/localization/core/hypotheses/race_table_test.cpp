// Tests L7, L8.
#include "localization/core/hypotheses/race_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "common/geometry/angles.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr double kPi = std::numbers::pi;

Race raceAt(double x, double health, int victories = 0, int age = 10) {
  Race race;
  race.T_world_robot = {x, 0.0, 0.0};
  race.health = health;
  race.victories = victories;
  race.age = age;
  return race;
}

/// A table with races 2 m apart, of the healths given; their ids are 1, 2, ...
RaceTable tableOf(std::initializer_list<double> healths, RaceParams params = {}) {
  params.create_health = 0.0;
  RaceTable table(params);
  double x = 0.0;
  for (const double health : healths) table.admit(raceAt(x += 2.0, health));
  return table;
}

TEST(RaceTable, ACandidateAtThePlaceOfARaceOnlyAgesIt) {
  RaceTable table = tableOf({0.9});
  EXPECT_EQ(table.admit(raceAt(2.1, 0.99)), RaceTable::Admission::kAged);
  ASSERT_EQ(table.races().size(), 1u);
  EXPECT_EQ(table.races()[0].age, 11);
  EXPECT_DOUBLE_EQ(table.races()[0].health, 0.9);
}

TEST(RaceTable, ACandidateOfLowHealthMakesNoRace) {
  RaceTable table{RaceParams{}};
  EXPECT_EQ(table.admit(raceAt(0.0, 0.59)), RaceTable::Admission::kIgnored);
  EXPECT_EQ(table.admit(raceAt(0.0, 0.61)), RaceTable::Admission::kCreated);
}

TEST(RaceTable, AFullTableReplacesTheWeakestRaceWithoutVictories) {
  RaceParams params;
  params.maximum = 3;
  RaceTable table = tableOf({0.8, 0.5, 0.4}, params);
  table.races()[2].victories = 1;  // the weakest has a victory
  EXPECT_EQ(table.admit(raceAt(20.0, 0.45)), RaceTable::Admission::kIgnored);
  EXPECT_EQ(table.admit(raceAt(20.0, 0.7)), RaceTable::Admission::kReplaced);
  EXPECT_EQ(table.races().size(), 3u);
  EXPECT_FALSE(table.find(2));
  EXPECT_TRUE(table.find(4));  // a new id, never used before
}

TEST(RaceTable, ARaceWithFarMoreEvidenceIsNotReplaced) {
  RaceParams params;
  params.maximum = 2;
  RaceTable table = tableOf({0.8, 0.5}, params);
  table.races()[1].evidence = -1.0;
  Race candidate = raceAt(20.0, 0.9);
  candidate.evidence = -1.0 - 1.1 * params.protected_log_odds;
  EXPECT_EQ(table.admit(candidate), RaceTable::Admission::kIgnored);
  candidate.evidence = -1.0 - 0.9 * params.protected_log_odds;
  EXPECT_EQ(table.admit(candidate), RaceTable::Admission::kReplaced);
  EXPECT_TRUE(table.find(1));
  EXPECT_FALSE(table.find(2));
}

TEST(RaceTable, NoRaceIsReplacedOrDeletedBeforeAgeThree) {
  RaceParams params;
  params.maximum = 1;
  RaceTable table = tableOf({0.1}, params);
  table.races()[0].age = 2;
  EXPECT_EQ(table.admit(raceAt(20.0, 0.9)), RaceTable::Admission::kIgnored);
  table.prune();
  EXPECT_EQ(table.races().size(), 1u);
  table.age();
  table.prune();
  EXPECT_TRUE(table.races().empty());
}

TEST(RaceTable, TheBestOfAnIterationIsProtectedForNineIterations) {
  RaceTable table = tableOf({0.1});
  table.recordBest(1);
  for (int i = 0; i < 8; ++i) table.age();
  table.prune();
  EXPECT_EQ(table.races().size(), 1u);
  table.age();
  table.prune();
  EXPECT_TRUE(table.races().empty());
}

TEST(RaceTable, PruningDeletesOnlyRacesWithoutVictoriesAndHealth) {
  RaceTable table = tableOf({0.59, 0.59, 0.61});
  table.races()[1].victories = 1;
  table.prune();
  EXPECT_FALSE(table.find(1));
  EXPECT_TRUE(table.find(2));
  EXPECT_TRUE(table.find(3));
}

/// Races and candidates of all ages at few places, so that they displace each other in every way.
TEST(RaceTableProperty, MayAdmitNeverRejectsAnAdmittedCandidate) {
  RaceParams params;
  params.maximum = 5;
  int ruled_out = 0;
  int admitted = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    RandomEngine engine(seed);
    const auto random = [&](double least_health) {
      Race race = raceAt(0.15 * static_cast<double>(pick(engine, 12)), uniform(engine, least_health, 1.0));
      race.age = static_cast<int>(pick(engine, 5));
      return race;
    };
    RaceTable table(params);
    for (std::size_t i = pick(engine, 9); i > 0; --i) table.admit(random(params.create_health));
    for (Race& race : table.races()) {
      race.victories = static_cast<int>(pick(engine, 2));
      if (pick(engine, 3) == 0) race.since_best = 1;
    }
    std::vector<Race> candidates;
    double most_health = 0.0;
    for (int i = 0; i < 6; ++i) {
      candidates.push_back(random(0.4));
      most_health = std::max(most_health, candidates.back().health);
    }
    std::vector<bool> may;
    for (const Race& one : candidates) may.push_back(table.mayAdmit(one, most_health));
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const auto admission = table.admit(candidates[i]);
      const bool is_in =
          admission == RaceTable::Admission::kCreated || admission == RaceTable::Admission::kReplaced;
      EXPECT_TRUE(may[i] || !is_in) << "seed " << seed << " candidate " << i;
      admitted += is_in ? 1 : 0;
      ruled_out += may[i] ? 0 : 1;
    }
  }
  EXPECT_GT(admitted, 1000);
  EXPECT_GT(ruled_out, 5000);
}

TEST(RaceTable, AMergeKeepsTheRaceWithMoreVictoriesThenMoreHealth) {
  RaceTable table = tableOf({0.9, 0.5, 0.7, 0.8});
  for (Race& race : table.races()) race.T_world_robot.x = race.id <= 2 ? 0.0 : 5.0;
  table.races()[1].victories = 2;  // id 2 beats the healthier id 1
  table.setWinner(1);
  table.mergeSamePlaces();
  ASSERT_EQ(table.races().size(), 2u);
  EXPECT_TRUE(table.find(2));
  EXPECT_TRUE(table.find(4));  // on a tie the healthier
  ASSERT_TRUE(table.winner());
  EXPECT_EQ(table.winner()->id, 2u);  // the title goes over with the place
}

TEST(RaceTable, YoungRacesMayMerge) {
  RaceTable table = tableOf({0.9, 0.5});
  for (Race& race : table.races()) {
    race.T_world_robot.x = 0.0;
    race.age = 0;
  }
  table.mergeSamePlaces();
  EXPECT_EQ(table.races().size(), 1u);
}

TEST(RaceTable, VictoriesStayBetweenZeroAndTwenty) {
  RaceTable table = tableOf({0.9, 0.5});
  for (int i = 0; i < 30; ++i) table.award(1);
  EXPECT_EQ(table.find(1)->victories, 20);
  EXPECT_EQ(table.find(2)->victories, 0);
  for (int i = 0; i < 5; ++i) table.award(2);
  EXPECT_EQ(table.find(1)->victories, 15);
  EXPECT_EQ(table.find(2)->victories, 5);
}

TEST(SelectByVictories, ASmallLeadDoesNotChangeTheWinner) {
  RaceTable table = tableOf({0.80, 0.70});
  for (int i = 0; i < 3; ++i) selectByVictories(table, 0.1);
  ASSERT_EQ(table.winner()->id, 1u);
  EXPECT_EQ(table.winner()->victories, 3);
  // Race 2 becomes the healthiest by 0.05: no victories change.
  table.races()[1].health = 0.85;
  selectByVictories(table, 0.1);
  EXPECT_EQ(table.find(1)->victories, 3);
  EXPECT_EQ(table.find(2)->victories, 0);
  // By 0.15: it gains one a time and the others lose one, until it has more (3,0 -> 2,1 -> 1,2).
  table.races()[1].health = 0.95;
  selectByVictories(table, 0.1);
  EXPECT_EQ(table.winner()->id, 1u);
  selectByVictories(table, 0.1);
  EXPECT_EQ(table.winner()->id, 2u);
}

TEST(RaceTable, ADeletedRaceIsNoLongerTheWinner) {
  RaceTable table = tableOf({0.1, 0.9});
  table.setWinner(1);
  table.prune();
  EXPECT_FALSE(table.winner());
}

}  // namespace
}  // namespace vismem
