// The short form of the series test/calibration/lens_series.cpp: rendered images, lens hidden from the tool.
#include <gtest/gtest.h>

#include <cmath>

#include "support/lens_trials.h"

namespace vismem {
namespace {

TEST(LensTrial, RenderedBoardsGiveTheLensToAThirdOfAPixel) {
  for (const unsigned seed : {901U, 902U}) {
    const LensTrial trial = tryLens(seed);
    ASSERT_EQ(trial.problem, "") << "seed " << seed;
    EXPECT_TRUE(trial.is_enough) << "seed " << seed << ", " << trial.images << " images";
    EXPECT_LT(trial.worst_px, 0.3) << "seed " << seed;
    EXPECT_LT(trial.calibration.heldOutRatio(), kMaxHeldOutRatio) << "seed " << seed;
    // Of one lens: the series pools twenty.
    EXPECT_LT(std::sqrt(trial.squares / trial.variance), 2.5) << "seed " << seed;
  }
}

}  // namespace
}  // namespace vismem
