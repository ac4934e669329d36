#include "common/memory/bounded_vector.h"

#include <gtest/gtest.h>

#include <vector>

namespace vismem {
namespace {

TEST(BoundedVector, IsAListOfItsValues) {
  BoundedVector<int, 3> list{4, 7};
  EXPECT_EQ(list.size(), 2U);
  EXPECT_EQ(list.front(), 4);
  list.push_back(9);
  EXPECT_EQ(std::vector<int>(list.begin(), list.end()), (std::vector<int>{4, 7, 9}));
  list.clear();
  EXPECT_TRUE(list.empty());
}

TEST(BoundedVector, LeavesOutWhatIsTooMany) {
  const std::vector<int> values{1, 2, 3, 4};
  BoundedVector<int, 3> list;
  list.assign(values.begin(), values.end());
  list.push_back(5);
  EXPECT_EQ(list, (BoundedVector<int, 3>{1, 2, 3}));
}

TEST(BoundedVector, ComparesTheValuesThatItHas) {
  BoundedVector<int, 3> list{1, 2, 3};
  list.assign(list.begin(), list.begin() + 1);
  EXPECT_EQ(list, (BoundedVector<int, 3>{1}));
  EXPECT_FALSE((list == BoundedVector<int, 3>{1, 2}));
}

}  // namespace
}  // namespace vismem
