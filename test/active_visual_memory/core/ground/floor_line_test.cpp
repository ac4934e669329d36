// Tests M3.
#include "active_visual_memory/core/ground/floor_line.h"

#include <gtest/gtest.h>

#include <random>

namespace vismem {
namespace {

FloorSegment piece(double x1, double y1, double x2, double y2, bool censored_a = false,
                   bool censored_b = false, double sigma = 0.01) {
  FloorSegment s;
  s.place({{x1, y1}, {x2, y2}});
  s.a.P = s.b.P = sigma * sigma * Eigen::Matrix2d::Identity();
  s.a.censored = censored_a;
  s.b.censored = censored_b;
  s.label = "edge";
  s.strength = 40.0;
  return s;
}

TEST(FloorLine, FusingASegmentWithItselfKeepsIt) {
  const FloorLine::Params params;
  const FloorSegment s = piece(0.3, -0.2, 1.1, 0.7);
  FloorLine line(s, params);
  for (int i = 0; i < 50; ++i) line.fuse(s, params);
  EXPECT_NEAR((line.segment().a - s.a.p).norm(), 0.0, 1e-9);
  EXPECT_NEAR((line.segment().b - s.b.p).norm(), 0.0, 1e-9);
}

TEST(FloorLine, WeighsByCovariance) {
  // A line at y = 0 known to 1 cm and one at y = 0.03 known to 1 cm meet half way, nearly: the small noise
  // added per fusion favours the newer one a little.
  const FloorLine::Params params;
  FloorLine line(piece(0, 0, 1, 0), params);
  line.fuse(piece(0, 0.03, 1, 0.03), params);
  EXPECT_NEAR(line.segment().middle().y(), 0.015, 0.002);
  // A third one, twenty times worse, hardly matters.
  line.fuse(piece(0, 0.5, 1, 0.5, false, false, 0.2), params);
  EXPECT_NEAR(line.segment().middle().y(), 0.015, 0.006);
}

TEST(FloorLine, ExtentIsTheUnionOfWhatWasSeen) {
  const FloorLine::Params params;
  FloorLine line(piece(0, 0, 1, 0, false, true), params);
  line.fuse(piece(0.8, 0, 2, 0, true, false), params);
  EXPECT_NEAR(line.segment().a.x(), 0.0, 1e-6);
  EXPECT_NEAR(line.segment().b.x(), 2.0, 1e-6);
  EXPECT_FALSE(line.endA().censored);
  EXPECT_FALSE(line.endB().censored);
}

TEST(FloorLine, ACensoredEndNeverShortens) {
  const FloorLine::Params params;
  FloorLine line(piece(0, 0, 2, 0), params);
  line.fuse(piece(0.5, 0, 1.5, 0, true, true), params);
  EXPECT_NEAR(line.segment().a.x(), 0.0, 1e-6);
  EXPECT_NEAR(line.segment().b.x(), 2.0, 1e-6);
  EXPECT_FALSE(line.endB().censored);
}

TEST(FloorLine, EndRules) {
  const FloorLine::Params p;  // end_gate_m = 0.03
  const double v = 1e-6;
  // Open known end, true end seen a little nearer: the true end wins. Far nearer: the known bound stays.
  const auto end = [&](double t, bool censored) { return ExtentEnd{t, v, censored, v, 1}; };
  EXPECT_DOUBLE_EQ(fuseEnds(end(1.0, true), end(0.99, false), 1.0, p).t_m, 0.99);
  EXPECT_DOUBLE_EQ(fuseEnds(end(1.0, true), end(0.5, false), 1.0, p).t_m, 1.0);
  // True end, censored one just beyond: noise. Far beyond: the line does go on.
  EXPECT_FALSE(fuseEnds(end(1.0, false), end(1.02, true), 1.0, p).censored);
  EXPECT_TRUE(fuseEnds(end(1.0, false), end(1.5, true), 1.0, p).censored);
  // The other direction mirrors it.
  EXPECT_DOUBLE_EQ(fuseEnds(end(-1.0, false), end(-1.5, false), -1.0, p).t_m, -1.5);
  EXPECT_DOUBLE_EQ(fuseEnds(end(-1.0, false), end(-0.5, false), -1.0, p).t_m, -1.0);
  // A true end that was seen well and often is not moved outwards by a view that is ten times worse.
  const ExtentEnd known{1.0, v, false, v, 5};
  EXPECT_DOUBLE_EQ(fuseEnds(known, {1.5, 10 * v, false, 10 * v, 1}, 1.0, p).t_m, 1.0);
  EXPECT_DOUBLE_EQ(fuseEnds(known, end(1.5, false), 1.0, p).t_m, 1.5);
}

TEST(FloorLine, NoisyObservationsConverge) {
  const FloorLine::Params params;
  std::mt19937_64 random(5);
  std::normal_distribution<double> gauss(0.0, 0.02);
  const auto noisy = [&] {
    return piece(1 + gauss(random), 1 + gauss(random), 2 + gauss(random), 1.5 + gauss(random), false, false,
                 0.02);
  };
  FloorLine line(noisy(), params);
  for (int i = 0; i < 100; ++i) line.fuse(noisy(), params);
  // One observation is 2 cm off; the filter keeps a memory of some ten observations.
  EXPECT_LT((line.segment().a - Eigen::Vector2d(1, 1)).norm(), 0.015);
  EXPECT_LT((line.segment().b - Eigen::Vector2d(2, 1.5)).norm(), 0.015);
}

TEST(FloorLine, ChapterFusionTakesTheNewerOrientationAndTheLongestExtent) {
  const FloorLine::Params params;
  FloorLine line(piece(0, 0, 2, 0), params);
  line.replaceKeepingExtent(piece(0.5, 0.01, 1.0, 0.02), params);
  // Slope of the newer: 0.01 / 0.5. Extent of the older.
  const Segment2 s = line.segment();
  EXPECT_NEAR((s.b.y() - s.a.y()) / (s.b.x() - s.a.x()), 0.02, 1e-9);
  EXPECT_NEAR(s.a.x(), 0.0, 0.001);
  EXPECT_NEAR(s.b.x(), 2.0, 0.001);
}

TEST(FloorLine, DisagreementGrowsWithDistance) {
  FloorLine line(piece(0, 0, 1, 0), {});
  EXPECT_LT(line.disagreement(piece(0, 0.01, 1, 0.01), 0.01), 1.0);
  EXPECT_GT(line.disagreement(piece(0, 0.2, 1, 0.2), 0.01), 9.0);
}

}  // namespace
}  // namespace vismem
