// Tests M9.
#include "active_visual_memory/core/markings/line_marking.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vismem {
namespace {

/// An element as three images saw it, its ends known with a standard deviation.
MemoryElement seen(std::uint64_t id, const Segment2& line, double sigma_m, bool confirmed = true) {
  FloorSegment segment;
  segment.place(line);
  segment.a.P = segment.b.P = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  segment.label = "line";
  MemoryElement element;
  element.value.id = id;
  element.value.label = "line";
  element.line = FloorLine(segment, {});
  for (int i = 0; i < 2; ++i) element.line.fuse(segment, {});
  publish(element, confirmed, CameraTiltCovariance::Zero());
  return element;
}

constexpr double kNear = 0.01;
constexpr double kFar = 0.10;

/// A bright line, bright on the left of each side.
std::vector<MemoryElement> lineAt(std::uint64_t id, double x, double width_m, double sigma_m) {
  return {seen(id, {{x, 1.0}, {x, 0.0}}, sigma_m),
          seen(id + 1, {{x + width_m, 0.0}, {x + width_m, 1.0}}, sigma_m)};
}

std::vector<MemorySegment> even(std::vector<MemoryElement> elements, const std::vector<MemoryElement>& more) {
  elements.insert(elements.end(), more.begin(), more.end());
  std::vector<MemorySegment> segments;
  for (const MemoryElement& element : elements) segments.push_back(element.value);
  const auto edges = publishedEdges(segments, elements);
  equalizeLineWidths(edges, measureLineWidths(edges, {}), {});
  return segments;
}

TEST(LineMarking, EdgesCloserThanTheMinimumAreSetApart) {
  const auto segments = even(lineAt(1, 0.0, 0.05, kNear), lineAt(3, 3.0, 0.005, kNear));
  EXPECT_NEAR(segments[1].odom.a.x(), 0.05, 1e-9) << "no side of another line moves";
  EXPECT_NEAR(segments[2].odom.a.x(), 3.0025 - 0.025, 1e-6);
  EXPECT_NEAR(segments[3].odom.a.x(), 3.0025 + 0.025, 1e-6);
}

TEST(LineMarking, FarEdgesTakeTheWidthOfNearLines) {
  // From afar both sides are found in its middle, even a little across each other.
  const auto segments = even(lineAt(1, 0.0, 0.05, kNear), lineAt(3, 3.0, -0.01, kFar));
  EXPECT_NEAR(segments[0].odom.a.x(), 0.0, 1e-9) << "what is well seen stays";
  EXPECT_NEAR(segments[1].odom.a.x(), 0.05, 1e-9);
  EXPECT_NEAR(segments[2].odom.a.x(), 2.995 - 0.025, 1e-6);
  EXPECT_NEAR(segments[2].odom.b.x(), 2.995 - 0.025, 1e-6);
  EXPECT_NEAR(segments[3].odom.a.x(), 2.995 + 0.025, 1e-6);
  EXPECT_NEAR(segments[3].odom.b.x(), 2.995 + 0.025, 1e-6);
  EXPECT_NEAR(segments[3].odom.b.y(), 1.0, 1e-6) << "its ends stay where they are along it";
}

TEST(LineMarking, EdgesStayWhereNearLinesHaveNoCommonWidth) {
  auto near = lineAt(1, 0.0, 0.05, kNear);
  const auto wide = lineAt(5, 1.0, 0.10, kNear);
  near.insert(near.end(), wide.begin(), wide.end());
  const auto segments = even(near, lineAt(7, 3.0, 0.03, kFar));
  EXPECT_NEAR(segments[4].odom.a.x(), 3.0, 1e-9);
  EXPECT_NEAR(segments[5].odom.a.x(), 3.03, 1e-9);
}

TEST(LineMarking, SpotsAreNotMeasured) {
  // Opposite sides of crosses, of which there are more than lines here.
  std::vector<MemoryElement> near = lineAt(1, 0.0, 0.05, kNear);
  for (const std::uint64_t id : {5u, 7u}) {
    const double y = static_cast<double>(id);
    near.push_back(seen(id, {{0.0, y + 0.05}, {0.0, y}}, kNear));
    near.push_back(seen(id + 1, {{0.10, y}, {0.10, y + 0.05}}, kNear));
  }
  const auto segments = even(near, lineAt(9, 3.0, 0.005, kFar));
  EXPECT_NEAR(segments[6].odom.a.x(), 3.0025 - 0.025, 1e-6);
  EXPECT_NEAR(segments[7].odom.a.x(), 3.0025 + 0.025, 1e-6);
}

TEST(LineMarking, EdgesThatWouldMoveTooFarStay) {
  const auto segments = even(lineAt(1, 0.0, 0.03, kNear), lineAt(3, 3.0, 0.125, kFar));
  EXPECT_NEAR(segments[2].odom.a.x(), 3.0, 1e-9);
  EXPECT_NEAR(segments[3].odom.a.x(), 3.125, 1e-9);
}

TEST(LineMarking, ConfirmsTheOtherEdgeOfAConfirmedOne) {
  const auto near = lineAt(1, 0.0, 0.05, kNear);
  const MemoryElement known = seen(3, {{3.0, 1.0}, {3.0, 0.0}}, kFar);
  const auto confirms = [&](const Segment2& line) {
    return even(near, {known, seen(4, line, kFar, false)}).back().confirmed;
  };
  EXPECT_TRUE(confirms({{3.04, 0.1}, {3.04, 0.9}}));
  EXPECT_FALSE(confirms({{3.04, 0.9}, {3.04, 0.1}})) << "bright on the other side";
  EXPECT_FALSE(confirms({{3.04, 0.5}, {3.04, 1.5}})) << "most of it runs beside nothing";
  EXPECT_FALSE(confirms({{3.20, 0.1}, {3.20, 0.9}})) << "no line is as wide";
  EXPECT_FALSE(confirms({{3.04, 0.1}, {3.04, 0.2}})) << "short";
}

TEST(LineMarking, AnEdgeHasOnePartner) {
  const auto near = lineAt(1, 0.0, 0.05, kNear);
  auto far = lineAt(3, 3.0, 0.05, kFar);
  far.push_back(seen(5, {{3.07, 0.1}, {3.07, 0.9}}, kFar, false));
  EXPECT_FALSE(even(near, far).back().confirmed) << "a copy of the partner that it has";
}

}  // namespace
}  // namespace vismem
