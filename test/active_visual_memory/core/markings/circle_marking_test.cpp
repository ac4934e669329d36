// Tests M9.
#include "active_visual_memory/core/markings/circle_marking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace vismem {
namespace {

constexpr double kRadius_m = 0.5;
constexpr int kChords = 10;
const Label kPaint = "paint";

/// A chord of an arc at an angle, as a line fitted to it lies. @param direction +1: counter-clockwise.
MemorySegment chord(std::uint64_t id, double radius_m, int of_ten, double direction) {
  const double angle = 2.0 * std::numbers::pi * of_ten / kChords;
  const double half_turn = std::numbers::pi / kChords;
  const double reach = radius_m * (1.0 - half_turn * half_turn / 6.0);
  const Eigen::Vector2d middle = reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d half =
      direction * radius_m * half_turn * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
  MemorySegment segment;
  segment.id = id;
  segment.label = kPaint;
  segment.confirmed = true;
  segment.odom.a = {(middle - half).x(), (middle - half).y(), 0.0};
  segment.odom.b = {(middle + half).x(), (middle + half).y(), 0.0};
  return segment;
}

Primitive circleOf(double width_m) {
  Primitive circle;
  circle.id = 7;
  circle.kind = PrimitiveKind::kCircle;
  circle.radius_m = kRadius_m;
  circle.width_m = width_m;
  return circle;
}

std::uint64_t idOf(int chord, int edge) {
  return 1000U + 100U * static_cast<std::uint64_t>(edge) + static_cast<std::uint64_t>(chord);
}

/// Published length within 12 mm of a radius.
double published(const std::vector<MemorySegment>& segments, double radius_m) {
  double length = 0.0;
  for (const MemorySegment& segment : segments) {
    if (std::abs(segment.odom.floor().middle().norm() - radius_m) < 0.012) length += segment.odom.length();
  }
  return length;
}

double around(double radius_m) {
  return 2.0 * std::numbers::pi * radius_m;
}

// A bright line seen from afar: its edges seem 2 cm apart.
std::vector<MemorySegment> farRing(double outward = 1.0) {
  std::vector<MemorySegment> segments;
  for (int i = 0; i < kChords; ++i) {
    segments.push_back(chord(segments.size() + 1, kRadius_m + 0.01, i, outward));
    segments.push_back(chord(segments.size() + 1, kRadius_m - 0.01, i, -outward));
  }
  return segments;
}

TEST(CircleMarking, EdgesTakeTheWidthOfLinesOfTheLabel) {
  for (const double sign : {1.0, -1.0}) {
    // Of a dark line the brighter side lies outside, all around.
    std::vector<MemorySegment> segments = farRing(sign);
    Primitive circle = circleOf(0.02);
    regularizeCircle(segments, circle, {{kPaint, sign * 0.06}}, {}, idOf);
    EXPECT_GT(published(segments, kRadius_m + 0.03), 0.95 * around(kRadius_m + 0.03)) << sign;
    EXPECT_GT(published(segments, kRadius_m - 0.03), 0.95 * around(kRadius_m - 0.03)) << sign;
    EXPECT_NEAR(circle.width_m, 0.06, 1e-9);
    EXPECT_NEAR(circle.radius_m, kRadius_m, 0.005);
    for (const MemorySegment& segment : segments) {
      const Segment2 floor = segment.odom.floor();
      const bool counter_clockwise = floor.a.x() * floor.b.y() - floor.a.y() * floor.b.x() > 0.0;
      EXPECT_EQ(counter_clockwise, (floor.middle().norm() > kRadius_m) == (sign > 0.0));
    }
  }
}

TEST(CircleMarking, EdgesStayWhereNoLineOfTheLabelIsMeasured) {
  std::vector<MemorySegment> segments = farRing();
  Primitive circle = circleOf(0.02);
  regularizeCircle(segments, circle, {{"other", 0.06}}, {}, idOf);
  EXPECT_GT(published(segments, kRadius_m + 0.01), 0.95 * around(kRadius_m + 0.01));
  EXPECT_EQ(published(segments, kRadius_m + 0.03), 0.0);
  EXPECT_NEAR(circle.width_m, 0.02, 1e-9);
}

TEST(CircleMarking, ADiscHasOneEdge) {
  std::vector<MemorySegment> segments;
  for (int i = 0; i < kChords; ++i) segments.push_back(chord(segments.size() + 1, kRadius_m, i, 1.0));
  Primitive circle = circleOf(0.0);
  regularizeCircle(segments, circle, {{kPaint, 0.06}}, {}, idOf);
  EXPECT_GT(published(segments, kRadius_m), 0.95 * around(kRadius_m));
  EXPECT_EQ(published(segments, kRadius_m - 0.06), 0.0);
  EXPECT_EQ(circle.width_m, 0.0);
  EXPECT_EQ(circle.radius_m, kRadius_m);
}

TEST(CircleMarking, ClosesShortGapsOnly) {
  for (const int missing : {1, 3}) {
    std::vector<MemorySegment> segments;
    for (int i = missing; i < kChords; ++i) {
      segments.push_back(chord(segments.size() + 1, kRadius_m, i, 1.0));
    }
    Primitive circle = circleOf(0.0);
    regularizeCircle(segments, circle, {}, {}, idOf);
    const double share = published(segments, kRadius_m) / around(kRadius_m);
    if (missing == 1) {
      EXPECT_GT(share, 0.95) << "36 degrees";
    } else {
      EXPECT_LT(share, 0.85) << "108 degrees";
    }
  }
}

TEST(CircleMarking, ChangesNothingBelowTheConfirmedShare) {
  std::vector<MemorySegment> segments = farRing();
  for (std::size_t i = 3; i < segments.size(); ++i) segments[i].confirmed = false;
  const std::size_t found = segments.size();
  Primitive circle = circleOf(0.02);
  regularizeCircle(segments, circle, {{kPaint, 0.06}}, {}, idOf);
  ASSERT_EQ(segments.size(), found);
  for (const MemorySegment& segment : segments) EXPECT_LT(segment.id, 1000U);
  EXPECT_EQ(circle.width_m, 0.02);
}

}  // namespace
}  // namespace vismem
