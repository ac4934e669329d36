// Tests M9.
#include "active_visual_memory/core/markings/line_marking.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vismem {
namespace {

/// An element as three images saw it, its ends known with a standard deviation.
MemoryElement seen(std::uint64_t id, const Segment2& line, double sigma_m) {
  FloorSegment segment;
  segment.place(line);
  segment.a.P = segment.b.P = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
  segment.label = "line";
  MemoryElement element;
  element.value.id = id;
  element.value.label = "line";
  element.line = FloorLine(segment, {});
  for (int i = 0; i < 2; ++i) element.line.fuse(segment, {});
  publish(element, true, CameraTiltCovariance::Zero());
  return element;
}

constexpr double kNear = 0.01;
constexpr double kFar = 0.10;

/// A bright line, bright on the left of each side.
std::vector<MemoryElement> lineAt(std::uint64_t id, double x, double width_m, double sigma_m) {
  return {seen(id, {{x, 1.0}, {x, 0.0}}, sigma_m),
          seen(id + 1, {{x + width_m, 0.0}, {x + width_m, 1.0}}, sigma_m)};
}

/// The width of the label "line" among these elements, 0 for none.
double widthOf(const std::vector<MemoryElement>& elements, const LineWidthParams& params = {}) {
  std::vector<MemorySegment> segments;
  for (const MemoryElement& element : elements) segments.push_back(element.value);
  const LineWidths widths = measureLineWidths(publishedEdges(segments, elements), params);
  return widths.contains("line") ? widths.at("line") : 0.0;
}

std::vector<MemoryElement> together(std::vector<MemoryElement> elements,
                                    const std::vector<MemoryElement>& more) {
  elements.insert(elements.end(), more.begin(), more.end());
  return elements;
}

TEST(LineMarking, NearLinesGiveTheWidthOfTheirLabel) {
  EXPECT_NEAR(widthOf(lineAt(1, 0.0, 0.05, kNear)), 0.05, 1e-9);
  EXPECT_NEAR(widthOf(together(lineAt(1, 0.0, 0.05, kNear), lineAt(3, 3.0, 0.005, kNear))), 0.05, 1e-9)
      << "closer edges than any line has do not count";
  EXPECT_EQ(widthOf(lineAt(1, 0.0, 0.05, kFar)), 0.0);
  EXPECT_NEAR(widthOf(together(lineAt(1, 0.0, 0.05, kNear), lineAt(3, 3.0, 0.08, kFar))), 0.05, 1e-9);
}

TEST(LineMarking, ADarkLineHasANegativeWidth) {
  EXPECT_NEAR(widthOf({seen(1, {{0.0, 0.0}, {0.0, 1.0}}, kNear), seen(2, {{0.05, 1.0}, {0.05, 0.0}}, kNear)}),
              -0.05, 1e-9);
}

TEST(LineMarking, NearLinesOfDifferentWidthsGiveNone) {
  EXPECT_EQ(widthOf(together(lineAt(1, 0.0, 0.05, kNear), lineAt(5, 1.0, 0.10, kNear))), 0.0);
}

TEST(LineMarking, WidthsBeyondTheRangeAreNotMeasured) {
  const auto wide = lineAt(1, 0.0, 0.15, kNear);
  EXPECT_EQ(widthOf(wide), 0.0);
  LineWidthParams params;
  params.range = {0.10, 0.20};
  EXPECT_NEAR(widthOf(wide, params), 0.15, 1e-9);
}

TEST(LineMarking, SpotsAreNotMeasured) {
  // Opposite sides of crosses, of which there are more than lines here.
  std::vector<MemoryElement> near = lineAt(1, 0.0, 0.05, kNear);
  for (const std::uint64_t id : {5u, 7u}) {
    const double y = static_cast<double>(id);
    near.push_back(seen(id, {{0.0, y + 0.05}, {0.0, y}}, kNear));
    near.push_back(seen(id + 1, {{0.10, y}, {0.10, y + 0.05}}, kNear));
  }
  EXPECT_NEAR(widthOf(near), 0.05, 1e-9);
}

}  // namespace
}  // namespace vismem
