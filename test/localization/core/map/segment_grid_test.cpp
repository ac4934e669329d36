// Tests L5, L12.
#include "localization/core/map/segment_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/config/config_error.h"
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
    item.number = static_cast<std::uint32_t>(i);
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
      for (const auto& item : items) {
        if (item.label != label || ((item.bins >> bin) & 1) == 0) continue;
        nearest = std::min(nearest, distanceToSegment(p, item.plan));
      }
      const auto found = grid.nearest({p, label, bin});
      ASSERT_EQ(found.has_value(), nearest < kReach_m) << "seed " << seed << " point " << p.transpose();
      if (!found) continue;
      ASSERT_NEAR(found->distance_m, nearest, 1e-9);
      ASSERT_NEAR(distanceToSegment(p, items[found->segment].plan), nearest, 1e-9);
      // The gradient: a small step along it makes the distance grow by as much.
      if (nearest > 1e-3) {
        const Eigen::Vector2d away = p + 1e-6 * found->gradient;
        ASSERT_NEAR(distanceToSegment(away, items[found->segment].plan) - nearest, 1e-6, 1e-9);
      }
    }
  }
}

/// Large enough that reading ahead does something, and its points lie everywhere, on no block too.
TEST(SegmentGrid, AnswersManyQueriesLikeSingleOnes) {
  const auto items = randomItems(9, 5000, 120.0);
  const SegmentGrid grid(items, 1.0, 0.5);
  RandomEngine engine(19);
  std::vector<SegmentGrid::Question> points{{{std::nan(""), 0.0}, 1, 2}, {{1e9, -1e9}, 1, 2}};
  for (int i = 0; i < 300; ++i)
    points.push_back({{uniform(engine, -40, 160), uniform(engine, -40, 160)}, 1, 2});
  std::vector<double> squares(points.size());
  grid.nearestSquares(points, squares);
  std::vector<std::optional<FieldSample>> samples(points.size(), FieldSample{});
  grid.nearest(points, samples);
  int found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = 1.0;
    for (const auto& item : items) {
      if (item.label != 1 || ((item.bins >> 2) & 1) == 0) continue;
      const double distance = distanceToSegment(points[i].p, item.plan);
      if (distance < nearest) nearest = distance;
    }
    EXPECT_NEAR(squares[i], nearest * nearest, 1e-9);
    const auto alone = grid.nearest(points[i]);
    ASSERT_EQ(samples[i].has_value(), nearest < 1.0);
    ASSERT_EQ(alone.has_value(), nearest < 1.0);
    if (alone) {
      EXPECT_EQ(samples[i]->distance_m, alone->distance_m);
      EXPECT_EQ(samples[i]->gradient, alone->gradient);
      EXPECT_EQ(samples[i]->segment, alone->segment);
      EXPECT_NEAR(alone->distance_m, nearest, 1e-9);
    }
    found += nearest < 1.0 ? 1 : 0;
  }
  EXPECT_GT(found, 10);
}

TEST(SegmentGrid, RefusesMoreItemsThanABlockCanIndex) {
  const std::vector<SegmentGrid::Item> many(65537, {{{0, 0}, {1, 0}}, 0, 1, 0});
  EXPECT_THROW(SegmentGrid(many, 1.0, 0.5), ConfigError);
}

TEST(SegmentGrid, IsEmptyWithoutItemsAndForNaN) {
  const SegmentGrid nothing({}, 1.0, 0.5);
  EXPECT_FALSE(nothing.nearest({{0, 0}, 0, 0}));
  const SegmentGrid one({{{{0, 0}, {1, 0}}, 0, 1, 7}}, 1.0, 0.5);
  EXPECT_EQ(one.nearest({{0.5, 0.2}, 0, 0})->segment, 7u);
  EXPECT_FALSE(one.nearest({{std::nan(""), 0}, 0, 0}));
  EXPECT_FALSE(one.nearest({{0.5, 0.2}, 1, 0}));
  EXPECT_FALSE(one.nearest({{0.5, 0.2}, 0, 1}));
}

TEST(SegmentGrid, RefusesItemsThatSpreadTooFar) {
  EXPECT_THROW(SegmentGrid({{{{0, 0}, {1e6, 1e6}}, 0, 1, 0}}, 1.0, 0.5), ConfigError);
}

}  // namespace
}  // namespace vismem
