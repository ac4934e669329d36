// Tests L4.
#include "localization/core/map/floor_cells.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "localization/core/random_engine.h"

namespace vismem {
namespace {

using Key = std::tuple<double, double, double, double>;

Key keyOf(const Segment2& line) {
  return {line.a.x(), line.a.y(), line.b.x(), line.b.y()};
}

struct Map {
  const char* name;
  double width_m, height_m, longest_m;
};

std::ostream& operator<<(std::ostream& out, const Map& map) {
  return out << map.name;
}

class FloorCellsProperty : public testing::TestWithParam<Map> {};

TEST_P(FloorCellsProperty, VisitsEveryLineInASquareAndFewOthers) {
  const Map& map = GetParam();
  RandomEngine engine(11);
  std::vector<Segment2> lines;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d a(uniform(engine, -5, map.width_m), uniform(engine, 7, 7 + map.height_m));
    const Eigen::Vector2d way(uniform(engine, -map.longest_m, map.longest_m),
                              map.height_m > 0.0 ? uniform(engine, -map.longest_m, map.longest_m) : 0.0);
    lines.push_back({a, i % 10 == 0 ? a : Eigen::Vector2d(a + way)});
  }
  const FloorCells cells(lines);
  std::size_t found = 0;
  std::size_t visited = 0;
  for (int i = 0; i < 500; ++i) {
    // Of every size, and beside the map too.
    const double reach_m = uniform(engine, 0, 1) < 0.5 ? uniform(engine, 0, 3) : uniform(engine, 0, 40);
    Eigen::Vector2d p(uniform(engine, -50, map.width_m + 50), uniform(engine, -50, map.height_m + 50));
    if (i % 3 == 0) p = lines[pick(engine, lines.size())].middle();
    std::set<Key> near;
    cells.visitNear(p, reach_m, [&](const Segment2& line) { near.insert(keyOf(line)); });
    visited += near.size();
    const Eigen::Vector2d low = p.array() - reach_m;
    const Eigen::Vector2d high = p.array() + reach_m;
    for (const Segment2& line : lines) {
      if (!clipToBox(line, low, high)) continue;
      ++found;
      ASSERT_TRUE(near.contains(keyOf(line))) << "place " << i << ", reach " << reach_m;
    }
  }
  EXPECT_GE(found, 167u) << "each third place has a line";
  EXPECT_LT(visited, 500 * lines.size() / 2) << "it is no search over all";
}

INSTANTIATE_TEST_SUITE_P(Maps, FloorCellsProperty,
                         testing::Values(Map{"building", 60, 40, 4}, Map{"long_lines", 100, 100, 80},
                                         Map{"desert", 5e6, 3e6, 4}, Map{"one_wall", 2000, 0, 5}),
                         testing::PrintToStringParamName());

TEST(FloorCells, VisitNothingInAnEmptyMap) {
  const FloorCells cells({});
  cells.visitNear({0, 0}, 1e9, [](const Segment2&) { FAIL(); });
}

}  // namespace
}  // namespace vismem
