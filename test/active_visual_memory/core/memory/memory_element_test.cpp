// Tests M3, M4.
#include "active_visual_memory/core/memory/memory_element.h"

#include <gtest/gtest.h>

#include <string>

namespace vismem {
namespace {

FloorSegment observed(const Segment2& line) {
  FloorSegment segment;
  segment.place(line);
  segment.a.P = segment.b.P = 1e-4 * Eigen::Matrix2d::Identity();
  return segment;
}

TEST(LabelVotes, TheNamedLabelWithTheMostVotesWinsIfItsShareIsLargeEnough) {
  LabelVotes votes;
  EXPECT_EQ(votes.winner(0.4), kUnknownLabel);
  votes.add("line", 2.0);
  votes.add("wall", 1.0);
  votes.add(kUnknownLabel, 2.0);
  EXPECT_EQ(votes.winner(0.4), "line") << "2 of 5";
  EXPECT_EQ(votes.winner(0.5), kUnknownLabel);
  LabelVotes others;
  others.add("wall", 4.0);
  votes.add(others);
  EXPECT_EQ(votes.winner(0.4), "wall") << "5 of 9";
}

TEST(LabelVotes, AFurtherLabelTakesThePlaceOfTheOneWithTheFewestVotes) {
  LabelVotes votes;
  for (int i = 1; i <= 8; ++i) votes.add("label" + std::to_string(i), i);
  votes.add("late", 20.0);
  EXPECT_EQ(votes.winner(0.36), "late") << "20 of 55";
  votes.add("label1", 0.5);
  votes.add("label8", 20.0);
  EXPECT_EQ(votes.winner(0.38), "label8") << "28 of 3 + ... + 7 + 28 + 20 + 0.5 = 73.5";
}

TEST(MemoryElement, AbsorbingAPieceKeepsTheIdTheLongestExtentAndTheBetterValues) {
  MemoryElement element;
  element.value.id = 3;
  element.value.life = 20.0;
  element.value.first_seen_us = 500;
  element.line = FloorLine(observed({{0.0, 0.0}, {1.0, 0.0}}), {});
  element.sightings = 4;
  MemoryElement piece;
  piece.value.id = 9;
  piece.value.label = "line";
  piece.value.life = 60.0;
  piece.value.first_seen_us = 100;
  piece.value.last_seen_us = 900;
  piece.sightings = 7;
  piece.plane.on_floor = true;
  // The opposite direction: its ends are exchanged first.
  piece.line = FloorLine(observed({{1.8, 0.0}, {0.8, 0.0}}), {});
  absorb(element, piece, {});
  EXPECT_EQ(element.value.id, 3U);
  EXPECT_EQ(element.value.label, "line");
  EXPECT_EQ(element.value.life, 60.0);
  EXPECT_EQ(element.value.first_seen_us, 100);
  EXPECT_EQ(element.value.last_seen_us, 900);
  EXPECT_EQ(element.sightings, 7);
  EXPECT_TRUE(element.plane.on_floor);
  EXPECT_NEAR(element.line.segment().a.x(), 0.0, 0.01);
  EXPECT_NEAR(element.line.segment().b.x(), 1.8, 0.01);
}

TEST(MemoryElement, IsLocatedIfBothEndsAreKnown) {
  MemorySegment segment;
  const auto withSigma = [](double sigma_m) {
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    P.topLeftCorner<2, 2>() = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    return P;
  };
  segment.P_a = segment.P_b = withSigma(0.9 * kMaxConfirmedSigma_m);
  EXPECT_TRUE(isLocated(segment));
  segment.P_b = withSigma(1.1 * kMaxConfirmedSigma_m);
  EXPECT_FALSE(isLocated(segment)) << "one end is unknown";
}

TEST(MemoryElement, PublishedCovariancesContainTheUnknownCameraTilt) {
  FloorSegment segment = observed({{2.0, -0.5}, {2.0, 0.5}});
  segment.a.D(0, 2) = segment.b.D(0, 2) = 10.0;  // 10 m of x per radian of camera pitch
  MemoryElement element;
  element.value.life = 50.0;
  element.line = FloorLine(segment, {});
  publish(element, true, CameraTiltCovariance::Zero());
  const double known = element.value.P_a(0, 0);
  CameraTiltCovariance P = CameraTiltCovariance::Zero();
  P(2, 2) = 0.01 * 0.01;
  publish(element, false, P);
  EXPECT_NEAR(element.value.P_a(0, 0) - known, 0.1 * 0.1, 1e-9) << "(10 m/rad * 0.01 rad)^2";
  EXPECT_FALSE(element.value.confirmed);
  EXPECT_DOUBLE_EQ(element.value.uncertainty, 1.0 / 50.0);
  EXPECT_EQ(element.value.odom.a.z(), 0.0);
}

}  // namespace
}  // namespace vismem
