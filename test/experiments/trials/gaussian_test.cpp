#include "experiments/trials/gaussian.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(StandardNormal, HasMeanZeroAndVarianceOne) {
  RandomEngine engine(1);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kDraws = 100'000;
  for (int i = 0; i < kDraws; ++i) {
    const double value = standardNormal(engine);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.015);
}

}  // namespace
}  // namespace vismem
