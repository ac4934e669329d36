// Tests L3.
#include "localization/core/observation/sampling_grid.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(SamplingGrid, RowsGrowFromTheTopToTheBottom) {
  const SamplingGrid grid(320, 240, 10, 40);
  const auto& borders = grid.rowBorders();
  ASSERT_GT(borders.size(), 5u);
  EXPECT_DOUBLE_EQ(borders[0], 0.0);
  EXPECT_DOUBLE_EQ(borders[1], 10.0);
  EXPECT_DOUBLE_EQ(borders.back(), 240.0);
  for (std::size_t i = 2; i + 1 < borders.size(); ++i) {
    EXPECT_GT(borders[i] - borders[i - 1], borders[i - 1] - borders[i - 2]);
  }
}

TEST(SamplingGrid, AVerticalLineCrossesEveryRow) {
  const SamplingGrid grid(320, 240, 10, 40);
  const auto points = grid.crossings({{3.0, 0.5}, {3.0, 239.0}});
  EXPECT_EQ(points.size(), grid.rowBorders().size() - 2);  // all borders but the first and the last
}

TEST(SamplingGrid, AHorizontalLineHasMorePointsAtTheTop) {
  const SamplingGrid grid(320, 240, 10, 40);
  const auto top = grid.crossings({{0.5, 5.0}, {319.0, 5.0}});
  const auto bottom = grid.crossings({{0.5, 230.0}, {319.0, 230.0}});
  EXPECT_EQ(top.size(), 31u);  // the first row is 10 px high: x = 10, 20 .. 310
  EXPECT_LT(bottom.size(), top.size() / 2);
}

}  // namespace
}  // namespace vismem
