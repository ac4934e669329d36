// Tests M1.
#include "active_visual_memory/core/markings/shadow_strips.h"

#include <gtest/gtest.h>

#include <utility>

#include "active_visual_memory/published_elements.h"

namespace vismem {
namespace {

TEST(ShadowStrips, TakeBackTheConfirmationOfTheFarEdgeOfABoxShadow) {
  const Eigen::Vector3d floor(43, 50, 45);
  const Eigen::Vector3d green(18, 91, 33);
  // A strip 12 cm wide, darker than both: the foot's brighter side is the box.
  MemoryElement foot = seen(1, {{0.0, 0.12}, {0.5, 0.12}}, false, 24.0);
  MemoryElement far_side = seen(2, {{0.5, 0.0}, {0.0, 0.0}}, false, 10.0);
  foot.colours = SideColours{green, floor};
  far_side.colours = SideColours{floor, green};
  const auto confirmed = [](const Published& p) {
    return std::pair(p.segments[0].confirmed, p.segments[1].confirmed);
  };
  EXPECT_EQ(confirmed(complete({foot, far_side})), std::pair(true, false));
  // A dark line of paint has one floor on both sides, and sides as strong.
  foot.colours = SideColours{floor, green};
  EXPECT_EQ(confirmed(complete({foot, far_side})), std::pair(true, true));
  foot.colours = SideColours{green, floor};
  far_side.strength = 24.0;
  EXPECT_EQ(confirmed(complete({foot, far_side})), std::pair(true, true));
}

}  // namespace
}  // namespace vismem
