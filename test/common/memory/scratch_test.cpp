#include "common/memory/scratch.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/allocations.h"

namespace vismem {
namespace {

TEST(Scratch, GivesItsMemoryAgainAfterARelease) {
  Scratch scratch(10000);
  const long before = test::allocations();
  for (int step = 0; step < 100; ++step) {
    scratch.release();
    std::pmr::vector<int> list(scratch.resource());
    for (int i = 0; i < 500; ++i) list.push_back(i);
    EXPECT_EQ(list.back(), 499);
  }
  EXPECT_EQ(test::allocations(), before);
}

TEST(Scratch, AllocatesForAStepThatNeedsMore) {
  Scratch scratch(100);
  const long before = test::allocations();
  std::pmr::vector<int> list(1000, 7, scratch.resource());
  EXPECT_EQ(list[999], 7);
  EXPECT_GT(test::allocations(), before);
}

}  // namespace
}  // namespace vismem
