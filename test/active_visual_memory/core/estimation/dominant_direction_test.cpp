// Tests M6.
#include "active_visual_memory/core/estimation/dominant_direction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(DominantDirection, ExistsOnlyInAPlaceOfRightAngles) {
  const auto holds = [](const std::vector<double>& directions_deg) {
    DominantDirection place({});
    for (const double d : directions_deg) place.add(degToRad(d), 1.0);
    return place.direction().has_value();
  };
  EXPECT_TRUE(holds({30.0, 121.0, -61.0, 210.5, 29.0}));
  EXPECT_TRUE(holds({44.0, -44.0, 45.5, -46.0})) << "across the seam";
  EXPECT_TRUE(holds({0.0, 90.0, 1.0, 91.0, 40.0})) << "one that lies askew";
  EXPECT_FALSE(holds({0.0, 90.0, 1.0})) << "too few";
  EXPECT_FALSE(holds({0.0, 90.0, 1.0, 91.0, 40.0, 55.0}));
  EXPECT_FALSE(holds({0.0, 15.0, 30.0, 45.0, 60.0, 75.0})) << "a round one";
  DominantDirection chords({});
  for (int i = 0; i < 12; ++i) chords.add(0.0, 0.2);
  EXPECT_FALSE(chords.direction().has_value());
}

TEST(DominantDirection, IgnoresALineOfAnotherDirection) {
  DominantDirection place({});
  for (const double d : {44.0, -44.0, 45.5, -46.0, 10.0}) place.add(degToRad(d), 1.0);
  ASSERT_TRUE(place.direction());
  // 44, 46, 45.5 and 44 degrees, modulo 90.
  EXPECT_NEAR(std::remainder(*place.direction() - degToRad(44.875), degToRad(90.0)), 0.0, degToRad(0.05));
}

TEST(DominantDirection, IsTheMeanOfItsLines) {
  const auto direction = [](const std::vector<double>& directions_deg) {
    DominantDirection place({});
    for (const double d : directions_deg) place.add(degToRad(d), 1.0);
    return place.direction();
  };
  // Modulo 90 degrees 30, 31, 29, 30.5, 29: their mean is 29.9.
  EXPECT_NEAR(radToDeg(direction({30.0, 121.0, -61.0, 210.5, 29.0}).value()), 29.9, 1e-3);
  // 44, 46, 45.5, 44: 44.875, which is as well -45.125.
  EXPECT_NEAR(radToDeg(offDominantDirection(direction({44.0, -44.0, 45.5, -46.0}).value(), degToRad(44.875))),
              0.0, 1e-3);
  EXPECT_FALSE(direction({0.0, 15.0, 30.0, 45.0, 60.0, 75.0}));
}

}  // namespace
}  // namespace vismem
