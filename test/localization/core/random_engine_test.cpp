// Tests L6: random draws are equal with every standard library.
#include "localization/core/random_engine.h"

#include <gtest/gtest.h>

#include <array>

namespace vismem {
namespace {

TEST(RandomEngine, IsTheStandardsMersenneTwister) {
  // ISO C++ fixes the 10000th output of a default-constructed mt19937_64.
  RandomEngine engine;
  engine.discard(9999);
  EXPECT_EQ(engine(), 9981545732273789042ULL);
}

TEST(Uniform, IsTheTopBitsScaledToTheInterval) {
  RandomEngine engine(5);
  RandomEngine same(5);
  const double expected = -2.0 + 5.0 * (static_cast<double>(same() >> 11) / 9007199254740992.0);  // 2^53
  EXPECT_EQ(uniform(engine, -2.0, 3.0), expected);
}

TEST(UniformProperty, StaysInTheHalfOpenIntervalAndHasItsMean) {
  RandomEngine engine(6);
  double sum = 0.0;
  constexpr int kCount = 100'000;
  for (int i = 0; i < kCount; ++i) {
    const double value = uniform(engine, -1.0, 3.0);
    ASSERT_GE(value, -1.0);
    ASSERT_LT(value, 3.0);
    sum += value;
  }
  // Standard deviation of the mean: 4 / sqrt(12) / sqrt(100000) = 0.0037.
  EXPECT_NEAR(sum / kCount, 1.0, 5 * 0.0037);
}

TEST(PickProperty, DrawsEveryIndexEquallyOften) {
  RandomEngine engine(7);
  std::array<int, 5> counts{};
  for (int i = 0; i < 50'000; ++i) ++counts.at(pick(engine, counts.size()));
  for (const int count : counts) EXPECT_NEAR(count, 10'000, 5 * 90);  // binomial: sigma 89
}

}  // namespace
}  // namespace vismem
