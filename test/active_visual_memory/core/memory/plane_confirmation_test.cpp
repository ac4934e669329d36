// Tests M1, M9.
#include "active_visual_memory/core/memory/plane_confirmation.h"

#include <gtest/gtest.h>

#include "active_visual_memory/published_elements.h"

namespace vismem {
namespace {

TEST(PlaneConfirmation, ConfirmsContinuationsOfAConfirmedEdge) {
  // The camera stands 0.45 m above (0, 0): what is 6 cm high is seen 0.154 of its distance too far. The
  // foot of a wall 2 m ahead, of which the first piece is confirmed, the second and third go on in its line,
  // and the fourth turns away at a corner.
  constexpr double kLimit = 0.06 / (0.45 - 0.06);
  const auto next = [](std::uint64_t id, const Segment2& line, bool censored_b = false) {
    MemoryElement element = seen(id, line, censored_b);
    element.plane.not_vertical = true;
    publish(element, false, CameraTiltCovariance::Zero());
    return element;
  };
  const Segment2 second{{1.02, 2.01}, {2.0, 2.0}};
  const auto confirms = [&](const MemoryElement& element) {
    std::vector<MemoryElement> elements{seen(1, {{0.0, 2.0}, {1.0, 2.0}}), element};
    confirmContinuations(elements, kLimit, {});
    return elements[1].value.confirmed;
  };
  std::vector<MemoryElement> wall{next(4, {{3.0, 2.02}, {3.0, 2.9}}), next(3, {{2.02, 2.0}, {2.98, 2.0}}),
                                  next(2, second), seen(1, {{0.0, 2.0}, {1.0, 2.0}})};
  confirmContinuations(wall, kLimit, {});
  for (const MemoryElement& element : wall) EXPECT_TRUE(element.value.confirmed) << element.value.id;

  EXPECT_TRUE(confirms(next(2, second)));
  // 10 cm high: at 2 / (1 - 0.1 / 0.45) = 2.57 m.
  EXPECT_FALSE(confirms(next(2, {{1.02, 2.57}, {2.0, 2.57}}))) << "the edge of something higher";
  EXPECT_FALSE(confirms(next(2, {second.b, second.a}))) << "the edge of another surface";
  EXPECT_FALSE(confirms(next(2, {{1.4, 2.0}, {2.0, 2.0}}))) << "it begins elsewhere";
  EXPECT_FALSE(confirms(next(2, second, true))) << "nobody knows where it ends";
  MemoryElement along = next(2, second);
  along.plane.anchor_camera = {0.0, 1.9};
  EXPECT_FALSE(confirms(along)) << "from there a higher edge is in line, too";
  MemoryElement maybe_vertical = next(2, second);
  maybe_vertical.plane.not_vertical = false;
  EXPECT_FALSE(confirms(maybe_vertical));
  MemoryElement standing = next(2, second);
  standing.plane.stands = true;
  EXPECT_FALSE(confirms(standing));
  MemoryElement other = next(2, {{1.0, 2.02}, {1.0, 2.9}});
  EXPECT_TRUE(confirms(other)) << "round the corner";
  other.value.label = "another";
  EXPECT_FALSE(confirms(other));
}

}  // namespace
}  // namespace vismem
