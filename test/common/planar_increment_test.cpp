#include "common/geometry/planar_increment.h"

#include <gtest/gtest.h>

#include <numbers>

namespace vismem {
namespace {

TEST(PlanarIncrement, RotatesAboutItsPivotThenShifts) {
  // A quarter turn about (1, 0) takes (2, 0) to (1, 1); the shift takes that to (1.5, 0.8).
  const PlanarIncrement increment{{1.0, 0.0}, {0.5, -0.2}, 0.5 * std::numbers::pi};
  EXPECT_NEAR((increment.apply({2.0, 0.0}) - Eigen::Vector2d(1.5, 0.8)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((increment.apply({1.0, 0.0}) - Eigen::Vector2d(1.5, -0.2)).norm(), 0.0, 1e-12) << "the pivot";
}

TEST(PlanarIncrement, KeepsDistances) {
  const PlanarIncrement increment{{0.3, -2.0}, {1.0, 2.0}, 0.7};
  const Eigen::Vector2d p{0.1, 0.2};
  const Eigen::Vector2d q{-3.0, 1.5};
  EXPECT_NEAR((increment.apply(p) - increment.apply(q)).norm(), (p - q).norm(), 1e-12);
  EXPECT_EQ(PlanarIncrement{}.apply(p), p);
}

}  // namespace
}  // namespace vismem
