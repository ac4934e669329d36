#include "experiments/core/memory_score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "experiments/app/over_runs.h"
#include "experiments/core/floor_truth.h"

namespace vismem {
namespace {

SegmentMap mapOf(const std::vector<Segment2>& edges, const char* label = "edge") {
  SegmentMap map;
  for (const Segment2& e : edges) {
    map.segments.push_back({{{e.a.x(), e.a.y(), 0.0}, {e.b.x(), e.b.y(), 0.0}}, label, 0.0});
  }
  return map;
}

/// 1 m above the origin, looking straight down on a square of about 1.15 m.
Pose3 lookingDown(double x = 0.0, double y = 0.0) {
  Pose3 pose = Pose3::Identity();
  pose.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  pose.translation() << x, y, 1.0;
  return pose;
}

CameraIntrinsics camera() {
  return intrinsicsFromFieldOfView(240, 240, std::numbers::pi / 3.0);
}

const SeesFloor kNothingInTheWay = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; };

RememberedEdge remembered(Segment2 s, bool confirmed = true) {
  return {1, s, "edge", confirmed};
}

TEST(FloorTruth, KnowsWhatAnImageShowedInFullAndUpToWhere) {
  FloorTruth truth(mapOf({{{-0.3, 0.0}, {0.3, 0.0}}, {{0.0, 0.2}, {3.0, 0.2}}}));
  EXPECT_EQ(truth.look(camera(), lookingDown(), kNothingInTheWay, 10.0), 2);
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
  truth.look(camera(), lookingDown(), half, 10.0);
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
  truth.look(camera(), lookingDown(), kNothingInTheWay, 10.0);
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

class OneEdge : public testing::Test {
 protected:
  OneEdge() : truth(mapOf({{{-0.4, 0.1}, {0.4, 0.1}}})) {
    truth.look(camera(), lookingDown(), kNothingInTheWay, 10.0);
  }
  FloorTruth truth;
};

TEST_F(OneEdge, IsRightWithinFiveCentimetresAndThreeDegrees) {
  using V = MemoryScore::Verdict;
  const auto verdict = [&](Segment2 s) {
    return scoreMemory({remembered(s)}, truth.edges()).judged[0].verdict;
  };
  EXPECT_EQ(verdict({{-0.4, 0.1}, {0.4, 0.1}}), V::kRight);
  EXPECT_EQ(verdict({{0.4, 0.1}, {-0.4, 0.1}}), V::kRight) << "its direction does not matter";
  EXPECT_EQ(verdict({{-0.44, 0.12}, {0.37, 0.12}}), V::kRight);
  EXPECT_EQ(verdict({{-0.4, 0.1}, {0.2, 0.1}}), V::kPartial) << "20 cm are missing";
  EXPECT_EQ(verdict({{-0.4, 0.1}, {0.55, 0.1}}), V::kPartial) << "15 cm too long";
  EXPECT_EQ(verdict({{-0.4, 0.2}, {0.4, 0.2}}), V::kFalse);
  EXPECT_EQ(verdict({{-0.4, 0.075}, {0.4, 0.125}}), V::kFalse) << "3.6 degrees";
}

TEST_F(OneEdge, CountsDuplicatesMissesAndWhatIsNotConfirmed) {
  auto score =
      scoreMemory({remembered({{-0.4, 0.1}, {0.4, 0.1}}), remembered({{-0.4, 0.12}, {0.4, 0.12}}),
                   remembered({{-0.4, 0.1}, {0.4, 0.1}}, false), remembered({{2, 2}, {3, 3}}, false)},
                  truth.edges());
  EXPECT_EQ(score.right, 2);
  EXPECT_DOUBLE_EQ(score.duplicates(), 2.0);
  EXPECT_DOUBLE_EQ(score.recall(), 1.0);
  EXPECT_EQ(score.unconfirmed, 2);
  EXPECT_EQ(score.unconfirmed_on_edges, 1);
  score = scoreMemory({}, truth.edges());
  EXPECT_DOUBLE_EQ(score.recall(), 0.0);
  EXPECT_EQ(score.missed, std::vector<int>{0});
}

TEST(MemoryScore, TwoEdgesBesideEachOtherNeedTwoElements) {
  FloorTruth truth(mapOf({{{-0.4, 0.00}, {0.4, 0.00}}, {{-0.4, 0.05}, {0.4, 0.05}}}));
  truth.look(camera(), lookingDown(), kNothingInTheWay, 10.0);
  auto score = scoreMemory({remembered({{-0.4, 0.025}, {0.4, 0.025}})}, truth.edges());
  EXPECT_EQ(score.found, 1);
  score = scoreMemory({remembered({{-0.4, 0.02}, {0.4, 0.02}}), remembered({{-0.4, 0.03}, {0.4, 0.03}})},
                      truth.edges());
  EXPECT_EQ(score.found, 2);
  EXPECT_DOUBLE_EQ(score.duplicates(), 1.0);
}

TEST(OverRuns, SumsUpWhatTheRunsHaveInCommon) {
  const std::vector<nlohmann::json> runs{
      {{"seed", 1}, {"name", "a"}, {"x", {{"p", 1.0}, {"ok", true}}}},
      {{"seed", 2}, {"name", "b"}, {"x", {{"p", 3.0}, {"ok", false}, {"q", 5}, {"r", nullptr}}}}};
  const auto all = overRuns(runs);
  EXPECT_FALSE(all.contains("seed"));
  EXPECT_FALSE(all.contains("name"));
  EXPECT_EQ(all["x"]["p"], (nlohmann::json{{"mean", 2.0}, {"min", 1.0}, {"max", 3.0}, {"runs", 2}}));
  EXPECT_EQ(all["x"]["ok"]["mean"], 0.5);
  EXPECT_EQ(all["x"]["q"]["runs"], 1);
  EXPECT_FALSE(all["x"].contains("r"));
  EXPECT_TRUE(overRuns({}).empty());
}

}  // namespace
}  // namespace vismem
