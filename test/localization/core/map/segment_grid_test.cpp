// Tests L5, L12.
#include "localization/core/map/segment_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "localization/core/random_engine.h"

namespace vismem {
namespace {

std::vector<SegmentGrid::Item> randomItems(std::uint64_t seed, int count, double extent_m) {
  RandomEngine engine(seed);
  std::vector<SegmentGrid::Item> items;
  for (int i = 0; i < count; ++i) {
    SegmentGrid::Item item;
    item.plan.a = {uniform(engine, 0, extent_m), uniform(engine, 0, extent_m)};
    item.plan.b = item.plan.a + Eigen::Vector2d(uniform(engine, -3, 3), uniform(engine, -3, 3));
    if (i % 10 == 0) item.plan.b = item.plan.a;  // a foot of something upright
    item.label = static_cast<int>(pick(engine, 3));
    item.bins = static_cast<std::uint16_t>(1 + pick(engine, 15));
    items.push_back(item);
  }
  return items;
}

class SegmentGrids : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Cells, SegmentGrids, testing::Values(0.1, 0.5, 3.0));

TEST_P(SegmentGrids, EqualExhaustiveSearch) {
  constexpr double kReach_m = 1.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto items = randomItems(seed, 60, 8.0);
    const SegmentGrid grid(items, kReach_m, GetParam());
    RandomEngine engine(100 + seed);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d p(uniform(engine, -6, 14), uniform(engine, -6, 14));
      const int label = static_cast<int>(pick(engine, 4));
      const int bin = static_cast<int>(pick(engine, 4));
      double nearest = kReach_m;
      Segment2 line;
      for (const auto& item : items) {
        if (item.label != label || ((item.bins >> bin) & 1) == 0) continue;
        const double distance = distanceToSegment(p, item.plan);
        if (distance < nearest) line = item.plan;
        nearest = std::min(nearest, distance);
      }
      ASSERT_NEAR(grid.nearestSquare({p, label, bin}), nearest * nearest, 1e-9);
      const auto found = grid.nearest({p, label, bin});
      ASSERT_EQ(found.has_value(), nearest < kReach_m) << "seed " << seed << " point " << p.transpose();
      if (!found) continue;
      ASSERT_NEAR(found->distance_m, nearest, 1e-9);
      // The gradient: a small step along it makes the distance grow by as much.
      if (nearest > 1e-3) {
        const Eigen::Vector2d away = p + 1e-6 * found->gradient;
        ASSERT_NEAR(distanceToSegment(away, line) - nearest, 1e-6, 1e-9);
      }
    }
  }
}

TEST(SegmentGrid, IsExactInALargeMapToo) {
  const auto items = randomItems(9, 5000, 120.0);
  const SegmentGrid grid(items, 1.0, 0.5);
  RandomEngine engine(19);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d p(uniform(engine, -40, 160), uniform(engine, -40, 160));
    double nearest = 1.0;
    for (const auto& item : items) {
      if (item.label == 1 && ((item.bins >> 2) & 1) != 0) {
        nearest = std::min(nearest, distanceToSegment(p, item.plan));
      }
    }
    EXPECT_NEAR(grid.nearestSquare({p, 1, 2}), nearest * nearest, 1e-9);
    found += nearest < 1.0 ? 1 : 0;
  }
  EXPECT_GT(found, 10);
  EXPECT_FALSE(grid.nearest({{1e9, -1e9}, 1, 2}));
}

TEST(SegmentGrid, IsEmptyWithoutItemsAndForNaN) {
  const SegmentGrid nothing({}, 1.0, 0.5);
  EXPECT_FALSE(nothing.nearest({{0, 0}, 0, 0}));
  const SegmentGrid one({{{{0, 0}, {1, 0}}, 0, 1}}, 1.0, 0.5);
  EXPECT_NEAR(one.nearest({{0.5, 0.2}, 0, 0})->distance_m, 0.2, 1e-12);
  EXPECT_FALSE(one.nearest({{std::nan(""), 0}, 0, 0}));
  EXPECT_FALSE(one.nearest({{0.5, 0.2}, 1, 0}));
  EXPECT_FALSE(one.nearest({{0.5, 0.2}, 0, 1}));
}

TEST(SegmentGrid, HasLargerCellsWhereItemsSpreadFar) {
  const SegmentGrid far({{{{0, 0}, {1, 0}}, 0, 1}, {{{1e6, 1e6}, {1e6, 1e6 + 1}}, 0, 1}}, 1.0, 0.5);
  EXPECT_NEAR(far.nearest({{0.5, 0.2}, 0, 0})->distance_m, 0.2, 1e-9);
  EXPECT_NEAR(far.nearest({{1e6 - 0.2, 1e6}, 0, 0})->distance_m, 0.2, 1e-9);
  EXPECT_FALSE(far.nearest({{5e5, 5e5}, 0, 0}));
}

}  // namespace
}  // namespace vismem
