#include "active_visual_memory/core/shape_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// A confirmed element that three images saw from end to end.
MemoryElement seen(std::uint64_t id, const Segment2& line, bool open_b = false, double strength = 100.0) {
  FloorSegment segment;
  segment.odom = line;
  segment.P_a = segment.P_b = 1e-4 * Eigen::Matrix2d::Identity();
  segment.open_b = open_b;
  segment.label = "line";
  MemoryElement element;
  element.value.id = id;
  element.value.label = "line";
  element.value.life = 50.0 + static_cast<double>(id);
  element.line = FloorLine(segment, {});
  for (int i = 0; i < 3; ++i) element.line.fuse(segment, {});
  element.strength = strength;
  publish(element, true, LeanCovariance::Zero());
  return element;
}

struct Published {
  std::vector<MemorySegment> segments;
  std::vector<Primitive> primitives;
};

Published complete(const std::vector<MemoryElement>& elements, std::vector<Primitive> primitives = {}) {
  Published published{{}, std::move(primitives)};
  for (const MemoryElement& element : elements) published.segments.push_back(element.value);
  std::uint64_t next = 1000;
  ShapeEdges shapes({});
  shapes.complete(published.segments, elements, published.primitives, [&] { return next++; });
  return published;
}

// A bright line from (0, 0) to (1, 0), 5 cm wide: its lower edge runs along +x (bright on the left).
const Segment2 kLower{{0.0, 0.0}, {1.0, 0.0}};
const Segment2 kUpper{{1.0, 0.05}, {0.0, 0.05}};

TEST(ShapeEdges, CloseBothEndsOfAPaintedLine) {
  const Published published = complete({seen(1, kLower), seen(2, kUpper)});
  ASSERT_EQ(published.segments.size(), 4U);
  for (std::size_t i = 2; i < 4; ++i) {
    const Segment2 end = published.segments[i].odom.floor();
    EXPECT_NEAR(end.length(), 0.05, 0.005);
    EXPECT_NEAR(lineAngleDifference(end.direction(), std::numbers::pi / 2), 0.0, 0.02);
    EXPECT_TRUE(published.segments[i].confirmed);
    EXPECT_EQ(published.segments[i].life, 51.0) << "the life of the side that is known less";
    // The bright side, left of a -> b, is the line's inside.
    const Eigen::Vector2d d = end.b - end.a;
    EXPECT_GT(d.x() * (0.025 - end.a.y()) - d.y() * (0.5 - end.a.x()), 0.0);
  }
}

TEST(ShapeEdges, LeaveOpenWhatTheImageBorderCut) {
  EXPECT_EQ(complete({seen(1, kLower, true), seen(2, kUpper)}).segments.size(), 3U);
}

TEST(ShapeEdges, CloseNoJunction) {
  // Another line meets the right end: its edges begin there.
  const Published published =
      complete({seen(1, kLower), seen(2, kUpper), seen(3, {{1.0, -0.01}, {1.3, -0.4}})});
  EXPECT_EQ(published.segments.size(), 4U) << "only the left end";
}

TEST(ShapeEdges, CutASideThatRanIntoAnEdgeInItsLine) {
  // The lower side goes on by 30 cm at its right end, then at its left one: both sides of a painted line end
  // together.
  for (const Segment2& over : {Segment2{{0.0, 0.0}, {1.3, 0.0}}, Segment2{{-0.3, 0.0}, {1.0, 0.0}}}) {
    const Published published = complete({seen(1, over), seen(2, kUpper)});
    ASSERT_EQ(published.segments.size(), 4U) << "and both ends are closed";
    const Segment2 cut = published.segments.front().odom.floor();
    EXPECT_EQ(published.segments.front().id, 1U);
    EXPECT_NEAR((cut.a - kLower.a).norm(), 0.0, 0.005);
    EXPECT_NEAR((cut.b - kLower.b).norm(), 0.0, 0.005);
  }
}

TEST(ShapeEdges, CutASideThatTheEdgeInItsLineMadeWeak) {
  const Published published = complete({seen(1, {{0.0, 0.0}, {1.3, 0.0}}, false, 45.0), seen(2, kUpper)});
  EXPECT_NEAR(published.segments.front().odom.length(), 1.0, 0.005);
}

TEST(ShapeEdges, CutASideOfALineWhoseSidesAreOneFromAfar) {
  const Published published = complete({seen(1, {{0.0, 0.04}, {1.3, 0.04}}), seen(2, kUpper)});
  EXPECT_NEAR(published.segments.front().odom.length(), 1.0, 0.005);
}

TEST(ShapeEdges, TurnAnEndThatWasSeenSquareToItsLine) {
  // 5 cm long, and 10 degrees askew; in its middle 1 cm behind the ends of the sides.
  const Eigen::Vector2d middle{1.01, 0.025};
  const Eigen::Vector2d half = 0.025 * Eigen::Vector2d(std::sin(degToRad(10.0)), std::cos(degToRad(10.0)));
  const Published published =
      complete({seen(1, kLower), seen(2, kUpper), seen(3, {middle - half, middle + half})});
  ASSERT_EQ(published.segments.size(), 4U) << "only the left end is added";
  const Segment2 end = published.segments[2].odom.floor();
  EXPECT_EQ(published.segments[2].id, 3U);
  EXPECT_NEAR((end.a - Eigen::Vector2d(1.01, 0.0)).norm(), 0.0, 0.003);
  EXPECT_NEAR((end.b - Eigen::Vector2d(1.01, 0.05)).norm(), 0.0, 0.003);
}

TEST(ShapeEdges, LetEndsThatMeetBeWhereTheirLinesCross) {
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

TEST(Corners, ConfirmWhatLiesBetweenThem) {
  // Three sides of a bright square, walked with the inside on the left; nothing has confirmed the middle one.
  const Segment2 first{{1.0, 0.0}, {1.0, 0.99}}, middle{{0.98, 1.0}, {0.02, 1.0}},
      last{{0.0, 0.98}, {0.0, 0.0}};
  const auto confirms = [&](MemoryElement between, const Label& label = "line") {
    std::vector<MemoryElement> elements{seen(1, first), std::move(between), seen(3, last)};
    elements[2].value.label = label;
    publish(elements[1], false, LeanCovariance::Zero());
    confirmBetweenCorners(elements, {});
    EXPECT_TRUE(elements[0].value.confirmed && elements[2].value.confirmed);
    return elements[1].value.confirmed;
  };
  EXPECT_TRUE(confirms(seen(2, middle)));
  EXPECT_FALSE(confirms(seen(2, middle, true))) << "an end is hidden";
  EXPECT_FALSE(confirms(seen(2, middle), "another")) << "the other edge is of another thing";
  EXPECT_FALSE(confirms(seen(2, {middle.b, middle.a}))) << "the edge of another surface";
  EXPECT_FALSE(confirms(seen(2, {{0.98, 1.0}, {0.3, 1.0}}))) << "one end meets nothing";
  EXPECT_FALSE(confirms(seen(2, {{0.98, 1.0}, {0.02, 1.3}}))) << "one end meets nothing";
  MemoryElement standing = seen(2, middle);
  standing.stands = true;
  EXPECT_FALSE(confirms(standing));
  MemoryElement unknown = seen(2, middle);
  unknown.value.label = kUnknownLabel;
  EXPECT_FALSE(confirms(unknown));
  // The ends of a thin line meet its sides; what is as short has no direction.
  std::vector<MemoryElement> thin{seen(1, kLower), seen(2, {{1.0, 0.0}, {1.0, 0.05}}), seen(3, kUpper)};
  publish(thin[1], false, LeanCovariance::Zero());
  confirmBetweenCorners(thin, {});
  EXPECT_FALSE(thin[1].value.confirmed);
}

TEST(Corners, ConfirmWhatGoesOnFromAConfirmedEdge) {
  // The camera stands 0.45 m above (0, 0): what is 6 cm high is seen 0.154 of its distance too far. The
  // foot of a wall 2 m ahead, of which the first piece is confirmed, the second and third go on in its line,
  // and the fourth turns away at a corner.
  constexpr double kCamera_m = 0.45;
  const auto next = [](std::uint64_t id, const Segment2& line, bool open_b = false) {
    MemoryElement element = seen(id, line, open_b);
    element.not_vertical = true;
    publish(element, false, LeanCovariance::Zero());
    return element;
  };
  const Segment2 second{{1.02, 2.01}, {2.0, 2.0}};
  const auto confirms = [&](const MemoryElement& element) {
    std::vector<MemoryElement> elements{seen(1, {{0.0, 2.0}, {1.0, 2.0}}), element};
    confirmContinuations(elements, kCamera_m, {});
    return elements[1].value.confirmed;
  };
  std::vector<MemoryElement> wall{next(4, {{3.0, 2.02}, {3.0, 2.9}}), next(3, {{2.02, 2.0}, {2.98, 2.0}}),
                                  next(2, second), seen(1, {{0.0, 2.0}, {1.0, 2.0}})};
  confirmContinuations(wall, kCamera_m, {});
  for (const MemoryElement& element : wall) EXPECT_TRUE(element.value.confirmed) << element.value.id;

  EXPECT_TRUE(confirms(next(2, second)));
  // 10 cm high: at 2 / (1 - 0.1 / 0.45) = 2.57 m.
  EXPECT_FALSE(confirms(next(2, {{1.02, 2.57}, {2.0, 2.57}}))) << "the edge of something higher";
  EXPECT_FALSE(confirms(next(2, {second.b, second.a}))) << "the edge of another surface";
  EXPECT_FALSE(confirms(next(2, {{1.4, 2.0}, {2.0, 2.0}}))) << "it begins elsewhere";
  EXPECT_FALSE(confirms(next(2, second, true))) << "nobody knows where it ends";
  MemoryElement along = next(2, second);
  along.anchor_camera = {0.0, 1.9};
  EXPECT_FALSE(confirms(along)) << "from there a higher edge is in line, too";
  MemoryElement maybe_vertical = next(2, second);
  maybe_vertical.not_vertical = false;
  EXPECT_FALSE(confirms(maybe_vertical));
  MemoryElement standing = next(2, second);
  standing.stands = true;
  EXPECT_FALSE(confirms(standing));
  MemoryElement other = next(2, {{1.0, 2.02}, {1.0, 2.9}});
  EXPECT_TRUE(confirms(other)) << "round the corner";
  other.value.label = "another";
  EXPECT_FALSE(confirms(other));
}

TEST(ShapeEdges, ConfirmNoFarSideOfTheShadowAlongABox) {
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

TEST(ShapeEdges, DoNotCutWhereTheOtherSideGoesOnOrALineBranchesOff) {
  const Segment2 over{{0.0, 0.0}, {1.5, 0.0}};
  const auto length = [](const Published& p) { return p.segments.front().odom.length(); };
  // A line of 5 cm that branches off interrupts the upper side.
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, kUpper), seen(3, {{1.5, 0.05}, {1.05, 0.05}})})), 1.5,
              0.01);
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, kUpper), seen(3, {{1.0, 0.05}, {1.0, 0.6}})})), 1.5,
              0.01);
  // An end that an image border cut is none, and a side of a line that is mostly alone has no partner.
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, {{0.0, 0.05}, {1.0, 0.05}})})), 1.5, 0.01)
      << "one polarity";
  EXPECT_NEAR(length(complete({seen(1, over), seen(2, {{0.3, 0.05}, {0.0, 0.05}})})), 1.5, 0.01);
}

TEST(ShapeEdges, EndTogetherAtTheLineThatOneSideReaches) {
  // The upper side was seen 20 cm short; the lower one ends at another line.
  const std::vector<MemoryElement> elements{seen(1, kLower), seen(2, {{0.8, 0.05}, {0.0, 0.05}}),
                                            seen(3, {{1.0, -1.0}, {1.0, 1.0}})};
  const Published published = complete(elements);
  for (const MemorySegment& segment : published.segments) {
    if (segment.id == 1) {
      EXPECT_NEAR(segment.odom.b.x(), 1.0, 1e-3) << "not cut";
    } else if (segment.id == 2) {
      EXPECT_NEAR(segment.odom.a.x(), 1.0, 1e-3) << "goes on";
      EXPECT_NEAR(segment.odom.b.x(), 0.0, 1e-3);
    }
  }
}

TEST(ShapeEdges, CloseNoStripOfShadow) {
  EXPECT_EQ(complete({seen(1, kLower), seen(2, kUpper, false, 30.0)}).segments.size(), 2U);
}

TEST(ShapeEdges, TellACircleInRegularChords) {
  // Ten chords of 0.3 m beside a circle of 0.5 m, as far views give them; every other one is confirmed.
  std::vector<MemoryElement> elements;
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.radius_m = 0.5;
  for (int i = 0; i < 10; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 10;
    const Eigen::Vector2d middle = 0.49 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d half = 0.16 * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
    elements.push_back(seen(static_cast<std::uint64_t>(i + 1), {middle - half, middle + half}));
    publish(elements.back(), i % 2 == 0, LeanCovariance::Zero());
    circle.segments.push_back(elements.back().value.id);
  }
  const Published published = complete(elements, {circle});
  double covered = 0.0;
  for (const MemorySegment& segment : published.segments) {
    EXPECT_GE(segment.id, 1000U) << "the chords found are not told beside the regular ones";
    EXPECT_TRUE(segment.confirmed);
    for (const Eigen::Vector2d& p : {segment.odom.floor().a, segment.odom.floor().middle()}) {
      EXPECT_NEAR(p.norm(), 0.5, 0.011);
    }
    covered += segment.odom.length();
  }
  EXPECT_GT(covered, 0.9 * 2.0 * std::numbers::pi * 0.5);
  EXPECT_EQ(published.primitives[0].segments.size(), published.segments.size());
}

TEST(ShapeEdges, TellARimWhereOnlyTheOtherOneWasSeen) {
  // The outer rim all around, half of the inner one.
  std::vector<MemoryElement> elements;
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.radius_m = 0.5;
  circle.width_m = 0.05;
  const auto add = [&](int i, double radius, double direction) {
    const double angle = 2.0 * std::numbers::pi * i / 10;
    const Eigen::Vector2d middle = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d half = direction * 0.16 * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
    elements.push_back(seen(elements.size() + 1, {middle - half, middle + half}));
    circle.segments.push_back(elements.back().value.id);
  };
  for (int i = 0; i < 10; ++i) add(i, 0.52, 1.0);
  for (int i = 0; i < 5; ++i) add(i, 0.47, -1.0);
  double inner = 0.0;
  for (const MemorySegment& segment : complete(elements, {circle}).segments) {
    if (segment.odom.floor().middle().norm() < 0.5) inner += segment.odom.length();
  }
  EXPECT_GT(inner, 0.9 * 2.0 * std::numbers::pi * 0.475);
}

TEST(ShapeEdges, KeepTheIdOfAnEdge) {
  const std::vector<MemoryElement> elements{seen(1, kLower), seen(2, kUpper)};
  std::uint64_t next = 1000;
  ShapeEdges shapes({});
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 2; ++i) {
    std::vector<MemorySegment> segments{elements[0].value, elements[1].value};
    std::vector<Primitive> none;
    shapes.complete(segments, elements, none, [&] { return next++; });
    ASSERT_EQ(segments.size(), 4U);
    ids.push_back(segments[2].id);
  }
  EXPECT_EQ(ids[0], ids[1]);
  EXPECT_EQ(next, 1002U);
}

/// The told edges with a direction but the ends of lines, by their begin along it.
std::vector<Segment2> along(const Published& published, double direction) {
  std::vector<Segment2> found;
  for (const MemorySegment& s : published.segments) {
    const Segment2 floor = s.odom.floor();
    const bool is_end = floor.length() < 0.1;  // of a line
    if (!is_end && std::abs(angleDifference(floor.direction(), direction)) < 0.1) found.push_back(floor);
  }
  std::sort(found.begin(), found.end(), [&](const Segment2& a, const Segment2& b) {
    return std::cos(direction) * (a.a.x() - b.a.x()) + std::sin(direction) * (a.a.y() - b.a.y()) < 0.0;
  });
  return found;
}

// A line along x from -1 to 1, 5 cm wide, and one below it along y that reaches it at x = 0.2: bright inside.
const Segment2 kTopOfBar{{1.0, 0.05}, {-1.0, 0.05}};
const Segment2 kBottomOfBar{{-1.0, 0.0}, {1.0, 0.0}};
const Segment2 kLeftOfStem{{0.175, 0.02}, {0.175, -1.0}};
const Segment2 kRightOfStem{{0.225, -1.0}, {0.225, -0.03}};

TEST(ShapeEdges, PartAnEdgeWhereALineJoinsIt) {
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, kBottomOfBar), seen(3, kLeftOfStem), seen(4, kRightOfStem)});
  const auto bottom = along(published, 0.0);
  ASSERT_EQ(bottom.size(), 2U) << "of the side that the other line joins";
  EXPECT_NEAR(bottom[0].a.x(), -1.0, 1e-3);
  EXPECT_NEAR(bottom[0].b.x(), 0.175, 1e-3);
  EXPECT_NEAR(bottom[1].a.x(), 0.225, 1e-3);
  EXPECT_NEAR(bottom[1].b.x(), 1.0, 1e-3);
  EXPECT_EQ(along(published, std::numbers::pi).size(), 1U) << "the other side goes on";
  // The sides of the joining line end on the edge.
  EXPECT_NEAR(along(published, -std::numbers::pi / 2)[0].a.y(), 0.0, 1e-3);
  EXPECT_NEAR(along(published, std::numbers::pi / 2)[0].b.y(), 0.0, 1e-3);
}

TEST(ShapeEdges, PartAllFourSidesWhereLinesCross) {
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, kBottomOfBar), seen(3, {{0.175, 1.0}, {0.175, -1.0}}),
                seen(4, {{0.225, -1.0}, {0.225, 1.0}})});
  for (const double direction : {0.0, std::numbers::pi / 2, std::numbers::pi, -std::numbers::pi / 2}) {
    EXPECT_EQ(along(published, direction).size(), 2U) << direction;
  }
}

TEST(ShapeEdges, DoNotPartAnEdgeThatALineEndsAwayFrom) {
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, kBottomOfBar), seen(3, {{0.175, -0.2}, {0.175, -1.0}}),
                seen(4, {{0.225, -1.0}, {0.225, -0.2}})});
  // The upper end of the stem is told, too: it is 5 cm long.
  const auto bottom = along(published, 0.0);
  EXPECT_EQ(std::count_if(bottom.begin(), bottom.end(), [](const Segment2& s) { return s.length() > 1.9; }),
            1);
}

TEST(ShapeEdges, DoNotPartTheOuterSideOfACorner) {
  // The stem reaches the bar at its right end: its right side meets the bar's end, the bar's top goes on.
  const Published published =
      complete({seen(1, kTopOfBar), seen(2, {{-1.0, 0.0}, {0.95, 0.0}}), seen(3, {{0.95, 0.0}, {0.95, -1.0}}),
                seen(4, {{1.0, -1.0}, {1.0, 0.05}})});
  const auto top = along(published, std::numbers::pi);
  ASSERT_EQ(top.size(), 1U);
  EXPECT_NEAR(top[0].length(), 2.0, 0.01);
  const auto bottom = along(published, 0.0);
  ASSERT_EQ(bottom.size(), 1U);
  EXPECT_NEAR(bottom[0].b.x(), 0.95, 1e-3);
}

TEST(ShapeEdges, PartALineWhereACircleCrossesIt) {
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.centre = {0.0, 0.0};
  circle.radius_m = 0.5;
  circle.width_m = 0.05;
  const Published published = complete({seen(1, {{-2.0, 0.0}, {2.0, 0.0}})}, {circle});
  const auto parts = along(published, 0.0);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_NEAR(parts[0].b.x(), -0.525, 1e-3);
  EXPECT_NEAR(parts[1].a.x(), -0.475, 1e-3);
  EXPECT_NEAR(parts[1].b.x(), 0.475, 1e-3);
  EXPECT_NEAR(parts[2].a.x(), 0.525, 1e-3);
}

}  // namespace
}  // namespace vismem
