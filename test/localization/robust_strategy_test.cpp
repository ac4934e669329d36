// Shares of belief of the default mode (SPEC L8, L12; DESIGN 9 part 4).
#include <gtest/gtest.h>

#include <cmath>

#include "localization/core/race_strategy.h"

namespace vismem {
namespace {

SegmentMap oneWall() {
  SegmentMap map;
  map.segments = {{{{0, 0, 0}, {3, 0, 0}}, "skirting", 0.0}};
  return map;
}

/// Shares of two races whose mean evidence differs by half a nat.
std::vector<double> sharesWith(double forgetting) {
  LocalizerParams params = localizerPreset(LocalizationMode::kDefault);
  params.robust.news_share = 0.15;
  params.robust.forgetting = forgetting;
  const auto strategy = makeRobustStrategy(oneWall(), params);
  RaceTable table(params.races);
  for (int i = 0; i < 2; ++i) {
    Race race;
    race.T_world_robot = {i * 5.0, 0.0, 0.0};
    race.health = 0.9;
    race.evidence = -1.0 - 0.5 * i;
    table.admit(race);
  }
  return strategy->weights(table);
}

TEST(RobustShares, CountWhatIsNewInTheObservationsThatEvidenceIsTheMeanOf) {
  // 20 observations with 3 independent ones among them: exp(-3 * 0.5).
  const std::vector<double> shares = sharesWith(0.95);
  ASSERT_EQ(shares.size(), 2u);
  EXPECT_NEAR(shares[0] + shares[1], 1.0, 1e-12);
  EXPECT_NEAR(shares[1] / shares[0], std::exp(-1.5), 1e-9);
}

TEST(RobustShares, OneObservationCountsOnce) {
  const std::vector<double> shares = sharesWith(0.0);
  EXPECT_NEAR(shares[1] / shares[0], std::exp(-0.5), 1e-9);
}

}  // namespace
}  // namespace vismem
