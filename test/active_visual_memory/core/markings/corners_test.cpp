// Tests M9.
#include "active_visual_memory/core/markings/corners.h"

#include <gtest/gtest.h>

#include "active_visual_memory/published_elements.h"

namespace vismem {
namespace {

TEST(Corners, PutBothEndsAtTheIntersectionOfTheirLines) {
  // Two sides of a bright square whose corner is (1, 0): one stops 3 cm short of it, one goes on by 2 cm.
  const Segment2 bottom{{0.0, 0.0}, {0.97, 0.0}};
  const Segment2 right{{1.0, -0.02}, {1.0, 0.8}};
  const auto corner = [](const MemorySegment& segment, bool at_b) {
    return Eigen::Vector2d((at_b ? segment.odom.b : segment.odom.a).head<2>());
  };
  const Published met = complete({seen(1, bottom), seen(2, right)});
  EXPECT_NEAR((corner(met.segments[0], true) - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((corner(met.segments[1], false) - Eigen::Vector2d(1.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(corner(met.segments[0], false).norm(), 0.0, 1e-6) << "the other end stays";
  // What is hidden or cut meets nothing, nor what is too far away, nor two edges of different surfaces.
  EXPECT_NEAR(corner(complete({seen(1, bottom, true), seen(2, right)}).segments[0], true).x(), 0.97, 1e-6);
  EXPECT_NEAR(corner(complete({seen(1, bottom), seen(2, {{1.2, 0.0}, {1.2, 0.8}})}).segments[0], true).x(),
              0.97, 1e-6);
  EXPECT_NEAR(corner(complete({seen(1, bottom), seen(2, {right.b, right.a})}).segments[0], true).x(), 0.97,
              1e-6);
}

}  // namespace
}  // namespace vismem
