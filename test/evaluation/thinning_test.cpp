#include "evaluation/core/thinning.h"

#include <gmock/gmock.h>

namespace vismem {
namespace {

std::vector<int> keptOf(int count, std::size_t capacity) {
  std::vector<int> kept;
  Thinning thinning(capacity);
  for (int i = 0; i < count; ++i) thinning.add(kept, i);
  return kept;
}

TEST(Thinning, KeepsAllUntilItIsFull) {
  EXPECT_THAT(keptOf(4, 4), testing::ElementsAre(0, 1, 2, 3));
}

TEST(Thinning, KeepsEverySecondAndTheNewest) {
  EXPECT_THAT(keptOf(5, 4), testing::ElementsAre(0, 2, 4));
  EXPECT_THAT(keptOf(6, 4), testing::ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(keptOf(7, 4), testing::ElementsAre(0, 2, 4, 6));
  EXPECT_THAT(keptOf(8, 4), testing::ElementsAre(0, 4, 7));
}

TEST(Thinning, StaysWithinItsCapacityEvenlySpaced) {
  for (int count = 1; count < 2000; ++count) {
    const std::vector<int> kept = keptOf(count, 16);
    ASSERT_LE(kept.size(), 16u) << count;
    ASSERT_EQ(kept.front(), 0);
    ASSERT_EQ(kept.back(), count - 1);
    for (std::size_t i = 2; i + 1 < kept.size(); ++i) ASSERT_EQ(kept[i] - kept[i - 1], kept[1]) << count;
    if (count > 16) {
      ASSERT_GE(kept.size(), 8u) << count;
    }
  }
}

}  // namespace
}  // namespace vismem
