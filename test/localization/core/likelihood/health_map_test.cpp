// Tests L10.
#include "localization/core/likelihood/health_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "localization/corridor_world.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

struct Best {
  Eigen::Vector2d place;
  double theta_rad;
  double health;
};

Best bestOf(const HealthMap& map) {
  const auto best = std::max_element(map.health.begin(), map.health.end());
  const auto index = static_cast<int>(best - map.health.begin());
  return {map.place(index % map.columns, index / map.columns), map.theta_rad[static_cast<std::size_t>(index)],
          *best};
}

class HealthMaps : public testing::TestWithParam<PlaceRating> {
 protected:
  // In front of the corner at the end of the first side: walls of two directions and a door in range.
  const SegmentMap map_ = test::corridorMap();
  const Pose2 truth_{7.0, 0.1, 0.0};

  MemoryUpdate update() const {
    MemoryUpdate update = test::viewFrom(map_, truth_, kSecondUs, 0.0, degToRad(-15));
    auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
    test::remember(*snapshot, map_, truth_, 3.0);
    return {snapshot, update.analysis};
  }
};
INSTANTIATE_TEST_SUITE_P(Ratings, HealthMaps,
                         testing::Values(PlaceRating::kImage, PlaceRating::kMemory, PlaceRating::kExplained,
                                         PlaceRating::kLikelihood),
                         [](const auto& which) {
                           switch (which.param) {
                             case PlaceRating::kImage:
                               return "Image";
                             case PlaceRating::kMemory:
                               return "Memory";
                             case PlaceRating::kExplained:
                               return "Explained";
                             case PlaceRating::kLikelihood:
                               return "Likelihood";
                           }
                           return "";
                         });

TEST_P(HealthMaps, AreHighestAtTheTruePose) {
  const HealthMapper mapper(HealthMapParams{}, map_);
  HealthMapRequest request;
  request.rating = GetParam();
  request.cell_m = 0.25;
  request.headings = 24;
  request.low = Eigen::Vector2d(-0.5, -0.4);  // (7, 0.1) is a place of the grid
  request.high = Eigen::Vector2d(8.5, 5.6);
  const auto map = mapper.map(update(), request);
  ASSERT_TRUE(map);
  EXPECT_EQ(map->stamp_us, kSecondUs);
  EXPECT_EQ(map->columns, 37);
  EXPECT_EQ(map->rows, 25);
  ASSERT_EQ(map->health.size(), 37u * 25u);
  const Best best = bestOf(*map);
  EXPECT_NEAR(best.place.x(), truth_.x, 1e-9);
  EXPECT_NEAR(best.place.y(), truth_.y, 1e-9);
  EXPECT_NEAR(angleDifference(best.theta_rad, truth_.theta), 0.0, 1e-6);
  EXPECT_GT(best.health, 0.85);
  EXPECT_TRUE(std::all_of(map->health.begin(), map->health.end(),
                          [](float health) { return health >= 0.0f && health <= 1.0f; }));
}

TEST_P(HealthMaps, AtOneHeadingAreNeverAboveTheBestOfAll) {
  const HealthMapper mapper(HealthMapParams{}, map_);
  HealthMapRequest request;
  request.rating = GetParam();
  request.cell_m = 0.5;
  request.headings = 8;
  const auto all = mapper.map(update(), request);
  request.theta_rad = degToRad(90);
  const auto one = mapper.map(update(), request);
  ASSERT_TRUE(all && one);
  for (std::size_t i = 0; i < all->health.size(); ++i) {
    // A likelihood is relative to the best place of its own grid.
    if (GetParam() != PlaceRating::kLikelihood) {
      ASSERT_LE(one->health[i], all->health[i] + 1e-6f) << i;
    }
    ASSERT_NEAR(one->theta_rad[i], degToRad(90), 1e-6);
  }
}

TEST_P(HealthMaps, AreEmptyWithoutEvidence) {
  const HealthMapper mapper(HealthMapParams{}, map_);
  HealthMapRequest request;
  request.rating = GetParam();
  const auto snapshot = std::make_shared<MemorySnapshot>();
  EXPECT_FALSE(mapper.map({snapshot, std::make_shared<ImageAnalysis>()}, request));
  EXPECT_FALSE(mapper.map(update(), request, [] { return true; }));  // cancelled
}

TEST(HealthMapRequest, IsCheckedWithFieldValueAndRule) {
  const SegmentMap map = test::corridorMap();
  EXPECT_EQ(checkRequest({}, map), "");
  HealthMapRequest request;
  request.cell_m = 0.0;
  EXPECT_NE(checkRequest(request, map).find("cell_m = 0 (must be > 0)"), std::string::npos);
  request.cell_m = 0.001;
  EXPECT_NE(checkRequest(request, map).find("makes more than 1e+06 places"), std::string::npos);
  request = {};
  request.headings = 0;
  EXPECT_NE(checkRequest(request, map).find("heading: 0"), std::string::npos);
  request.theta_rad = std::nan("");
  EXPECT_NE(checkRequest(request, map).find("must be finite"), std::string::npos);
  request = {};
  request.low = Eigen::Vector2d(1e3, 0.0);
  EXPECT_NE(checkRequest(request, map).find("low <= high"), std::string::npos);
  // 11 x 21 places, at 36 headings each.
  request = {};
  request.low = {0.0, 0.0};
  request.high = {1.0, 2.0};
  EXPECT_EQ(checkRequest(request, map, {231.0, 8316.0}), "");
  EXPECT_NE(checkRequest(request, map, {230.0, 8316.0}).find("makes more than 230 places of 1 x 2 m"),
            std::string::npos);
  EXPECT_NE(
      checkRequest(request, map, {231.0, 8315.0}).find("headings = 36 at 231 places make more than 8315"),
      std::string::npos);
  request.theta_rad = 0.0;
  EXPECT_EQ(checkRequest(request, map, {231.0, 231.0}), "");
}

}  // namespace
}  // namespace vismem
