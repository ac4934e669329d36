#include "evaluation/core/floor_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "evaluation/core/memory_score.h"
#include "evaluation/floor_view.h"

namespace vismem {
namespace {

TEST(FloorTruth, KnowsWhatAnImageShowedInFullAndUpToWhere) {
  FloorTruth truth(mapOf({{{-0.3, 0.0}, {0.3, 0.0}}, {{0.0, 0.2}, {3.0, 0.2}}}));
  EXPECT_EQ(truth.addView(camera(), lookingDown(), kNothingInTheWay, 10.0), 2);
  ASSERT_EQ(truth.edges().size(), 2u);
  EXPECT_TRUE(truth.edges()[0].shown_in_full);
  EXPECT_NEAR(truth.edges()[0].longest_view_px, 0.6 * camera().fx, 1.0);
  EXPECT_FALSE(truth.edges()[1].shown_in_full);
  double last = 0.0;
  for (const auto& sample : truth.edges()[1].samples) {
    if (sample.seen) last = sample.p.x();
  }
  EXPECT_NEAR(last, std::tan(std::numbers::pi / 6.0), 0.03);
}

TEST(FloorTruth, WhatIsCoveredIsNotShown) {
  FloorTruth truth(mapOf({{{-0.3, 0.0}, {0.3, 0.0}}}));
  const SeesFloor half = [](const Eigen::Vector3d&, const Eigen::Vector3d& p) { return p.x() < 0.0; };
  truth.addView(camera(), lookingDown(), half, 10.0);
  EXPECT_FALSE(truth.edges()[0].shown_in_full);
  // The same edge, whose hidden end is right where it was last visible.
  const auto score = scoreMemory({remembered({{-0.3, 0.0}, {-0.01, 0.0}})}, truth.edges());
  EXPECT_EQ(score.right, 1);
  EXPECT_EQ(score.shown, 0);
  EXPECT_EQ(scoreMemory({remembered({{-0.3, 0.0}, {0.3, 0.0}})}, truth.edges()).right, 0);
}

TEST(FloorTruth, AnOutlineOfManyShortPiecesIsOneCurve) {
  std::vector<Segment2> pieces;
  for (int i = 0; i < 48; ++i) {
    const auto at = [](int k) {
      const double a = 2.0 * std::numbers::pi * k / 48;
      return Eigen::Vector2d(0.3 * std::cos(a), 0.3 * std::sin(a));
    };
    // Not in order, and not all in one direction.
    const int k = (i * 7) % 48;
    pieces.push_back(k % 2 ? Segment2{at(k), at(k + 1)} : Segment2{at(k + 1), at(k)});
  }
  pieces.push_back({{0.4, 0.0}, {0.45, 0.0}});
  FloorTruth truth(mapOf(pieces));
  ASSERT_EQ(truth.edges().size(), 2u);
  const auto& circle = truth.edges()[0];
  EXPECT_TRUE(circle.curve);
  EXPECT_TRUE(circle.closed);
  EXPECT_NEAR(circle.length_m, 2.0 * std::numbers::pi * 0.3, 0.01);
  truth.addView(camera(), lookingDown(), kNothingInTheWay, 10.0);
  EXPECT_TRUE(truth.edges()[0].shown_in_full);

  // Twelve chords remember it; half of them do not.
  std::vector<RememberedEdge> memory;
  for (int i = 0; i < 12; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 12;
    const double b = 2.0 * std::numbers::pi * (i + 1) / 12;
    memory.push_back(
        remembered({{0.3 * std::cos(a), 0.3 * std::sin(a)}, {0.3 * std::cos(b), 0.3 * std::sin(b)}}));
  }
  auto score = scoreMemory(memory, truth.edges());
  EXPECT_EQ(score.right, 12);
  EXPECT_EQ(score.found, 1);
  EXPECT_NEAR(score.duplicates(), 1.0, 0.05);
  auto twice = memory;
  twice.insert(twice.end(), memory.begin(), memory.end());
  EXPECT_NEAR(scoreMemory(twice, truth.edges()).duplicates(), 2.0, 0.1);
  memory.resize(6);
  score = scoreMemory(memory, truth.edges());
  EXPECT_EQ(score.right, 6);
  EXPECT_EQ(score.found, 0);
}

}  // namespace
}  // namespace vismem
