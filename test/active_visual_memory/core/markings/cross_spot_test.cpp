// Tests M9.
#include "active_visual_memory/core/markings/cross_spot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr double kWidth = 0.05;
constexpr double kArm = 0.05;

MemoryElement seen(std::uint64_t id, const Segment2& line, bool on_floor = true) {
  FloorSegment segment;
  segment.place(line);
  segment.a.P = segment.b.P = 1e-4 * Eigen::Matrix2d::Identity();
  segment.label = "line";
  MemoryElement element;
  element.value.id = id;
  element.value.label = "line";
  element.line = FloorLine(segment, {});
  element.sightings = 10;
  element.plane.on_floor = on_floor;
  publish(element, on_floor, CameraTiltCovariance::Zero());
  return element;
}

/// A square of lines 4 m wide, turned: what the direction is measured from.
std::vector<MemoryElement> square(double turn_rad) {
  const Eigen::Rotation2Dd turn(turn_rad);
  const Eigen::Vector2d corners[] = {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
  std::vector<MemoryElement> lines;
  for (int i = 0; i < 4; ++i) {
    lines.push_back(seen(1 + i, {turn * corners[i], turn * corners[(i + 1) % 4]}));
  }
  return lines;
}

/// The slanting edge of a bright cross in one quadrant, the paint on its left.
Segment2 slanting(const Eigen::Vector2d& centre, double quadrant, double turn_rad) {
  const Eigen::Rotation2Dd turn(turn_rad + (quadrant - 1.0) * M_PI_2);
  return {centre + turn * Eigen::Vector2d(kArm, 0.5 * kWidth),
          centre + turn * Eigen::Vector2d(0.5 * kWidth, kArm)};
}

std::vector<MemorySegment> replaced(const std::vector<MemoryElement>& elements, double width = kWidth) {
  std::vector<MemorySegment> segments;
  for (const MemoryElement& element : elements) segments.push_back(element.value);
  CrossSpotParams params;
  params.enabled = true;
  replaceCrossSpots(segments, publishedEdges(segments, elements), {{"line", width}}, {}, params,
                    [](std::uint64_t oldest, int n) { return 1000 * oldest + n; });
  return segments;
}

TEST(CrossSpot, IsPublishedAsTheEndsOfItsArms) {
  for (const double turn_rad : {0.0, 0.2, 0.7}) {
    const Eigen::Vector2d centre(0.3, -0.4);
    auto elements = square(turn_rad);
    elements.push_back(seen(11, slanting(centre, 1, turn_rad)));
    elements.push_back(seen(12, slanting(centre, 3, turn_rad), false));
    const auto segments = replaced(elements);
    ASSERT_EQ(segments.size(), 8u) << turn_rad;
    const Eigen::Rotation2Dd turn(turn_rad);
    // Whichever quarter turn the direction is counted from: each true end is published once.
    for (int n = 0; n < 4; ++n) {
      const Eigen::Rotation2Dd arm(turn_rad + n * M_PI_2);
      const Eigen::Vector2d a = centre + arm * Eigen::Vector2d(kArm, -0.5 * kWidth);
      const Eigen::Vector2d b = centre + arm * Eigen::Vector2d(kArm, 0.5 * kWidth);
      const auto published = std::count_if(segments.begin(), segments.end(), [&](const MemorySegment& s) {
        return (s.odom.floor().a - a).norm() < 1e-3 && (s.odom.floor().b - b).norm() < 1e-3 && s.confirmed;
      });
      EXPECT_EQ(published, 1) << turn_rad << " " << n;
    }
  }
}

TEST(CrossSpot, AnObservedArmEndTakesPartInTheFit) {
  auto elements = square(0.0);
  elements.push_back(seen(11, slanting({0.0, 0.0}, 1, 0.0)));
  elements.push_back(seen(12, slanting({0.0, 0.0}, 2, 0.0)));
  elements.push_back(seen(13, {{kArm, -0.5 * kWidth}, {kArm, 0.5 * kWidth}}));
  const auto segments = replaced(elements);
  ASSERT_EQ(segments.size(), 8u);
  EXPECT_NEAR((segments[4].odom.floor().middle() - Eigen::Vector2d(kArm, 0.0)).norm(), 0.0, 1e-3);
}

TEST(CrossSpot, IsConfirmedOnlyByAnEdgeOnTheFloor) {
  auto elements = square(0.0);
  elements.push_back(seen(11, slanting({0.0, 0.0}, 1, 0.0), false));
  elements.push_back(seen(12, slanting({0.0, 0.0}, 3, 0.0), false));
  const auto segments = replaced(elements);
  ASSERT_EQ(segments.size(), 8u);
  for (std::size_t i = 4; i < 8; ++i) EXPECT_FALSE(segments[i].confirmed);
}

TEST(CrossSpot, LeavesOtherEdgesAsTheyWere) {
  auto lone = square(0.0);
  lone.push_back(seen(11, slanting({0.0, 0.0}, 1, 0.0)));
  EXPECT_EQ(replaced(lone).size(), 5u) << "one edge";

  auto apart = lone;
  apart.push_back(seen(12, slanting({0.2, 0.2}, 3, 0.0)));
  EXPECT_EQ(replaced(apart).size(), 6u) << "of two things";

  auto dark = lone;
  dark.push_back(seen(12, slanting({0.0, 0.0}, 3, 0.0)));
  EXPECT_EQ(replaced(dark, -kWidth).size(), 6u) << "a hole in paint, where lines are dark";

  auto joining = dark;
  joining.push_back(seen(13, {{0.1, 0.0}, {1.0, 0.0}}));
  EXPECT_EQ(replaced(joining).size(), 7u) << "where a line ends";

  auto askew = dark;
  for (int i = 0; i < 4; ++i) askew[i] = seen(1 + i, {{0.0, i - 2.0}, {2.0, i * 0.7}});
  EXPECT_EQ(replaced(askew).size(), 6u) << "no dominant direction";
}

}  // namespace
}  // namespace vismem
