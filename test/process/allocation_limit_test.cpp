// The limit of single allocations, which holds for every user of `new` in the process.
#include "common/process/allocation_limit.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <new>
#include <vector>

namespace vismem {
namespace {

constexpr std::size_t kLimit = std::size_t{1} << 20;

class AllocationLimitTest : public testing::Test {
 protected:
  AllocationLimitTest() { limitAllocations(kLimit); }
  ~AllocationLimitTest() override { limitAllocations(std::numeric_limits<std::size_t>::max()); }
};

TEST_F(AllocationLimitTest, WhatIsLargerThrows) {
  EXPECT_THROW(std::vector<char>(kLimit + 1), std::bad_alloc);
  EXPECT_THROW(std::make_unique<char[]>(kLimit + 1), std::bad_alloc);
}

TEST_F(AllocationLimitTest, AsMuchAsThatIsGivenAndTakenBack) {
  for (int i = 0; i < 3; ++i) {
    std::vector<char> all(kLimit, 'a');
    EXPECT_EQ(all.back(), 'a');
  }
}

}  // namespace
}  // namespace vismem
