// Merging collinear segments of one label.
// Tests V4.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/vision/collinear_merge.h"
#include "common/vision/segment_merge.h"

namespace vismem {
namespace {

constexpr MergeParams kParams{0.07, 1.5, 8.0};

ImageSegment segment(double x1, double y1, double x2, double y2, const Label& label = "edge",
                     double strength = 10.0) {
  return {{{x1, y1}, {x2, y2}}, label, strength};
}

std::vector<ImageSegment> mergeSegments(std::vector<ImageSegment> segments, const MergeParams& params) {
  SegmentMerger().merge(segments, params);
  return segments;
}

bool near(const std::vector<ImageSegment>& x, const std::vector<ImageSegment>& y, double tolerance) {
  return std::equal(
      x.begin(), x.end(), y.begin(), y.end(), [&](const ImageSegment& a, const ImageSegment& b) {
        return a.label == b.label && (a.px.a - b.px.a).norm() <= tolerance &&
               (a.px.b - b.px.b).norm() <= tolerance && std::abs(a.strength - b.strength) <= tolerance;
      });
}

// Two pieces of a line along x with a gap of 5 px: one of 60, strength the length-weighted mean (30*10 +
// 25*21)/55.
TEST(MergeSegments, WorkedExample) {
  const auto merged = mergeSegments({segment(35, 0, 60, 0, "edge", 21), segment(0, 0, 30, 0)}, kParams);
  ASSERT_EQ(merged.size(), 1u);
  EXPECT_NEAR(merged[0].px.a.x(), 0, 1e-9);
  EXPECT_NEAR(merged[0].px.b.x(), 60, 1e-9);
  EXPECT_NEAR(merged[0].px.a.y(), 0, 1e-9);
  EXPECT_NEAR(merged[0].strength, 15.0, 1e-9);
}

/// Says the same of every gap and remembers the last one.
class SameAnswer final : public GapEvidence {
 public:
  explicit SameAnswer(bool answer) : answer_(answer) {}
  bool goesOn(const Segment2& gap, const Segment2& before, const Segment2& after) const override {
    last = gap;
    EXPECT_EQ(gap.a, before.b);
    EXPECT_EQ(gap.b, after.a);
    return answer_;
  }
  mutable Segment2 last;

 private:
  bool answer_;
};

// Gaps of up to 8 px are closed unasked; beyond, as far as half of the shorter piece's length and 12 px,
// evidence decides.
TEST(CollinearMerger, LongerGapsAreClosedWhereTheEdgeGoesOn) {
  const CollinearMergeParams params{0.07, 1.5, 8.0, 0.5, 12.0};
  const auto joined = [&](double length, double gap_px, const GapEvidence* evidence) {
    CollinearMerger merger;
    std::vector<GroupedSegment> pieces{{{{40 + gap_px, 50}, {40 + gap_px + length, 50}}},
                                       {{{0, 50}, {40, 50}}}};
    merger.merge(pieces, params, evidence);
    return pieces.size() == 1;
  };
  const SameAnswer yes(true);
  const SameAnswer no(false);
  EXPECT_TRUE(joined(30, 7.5, &no));
  EXPECT_TRUE(joined(30, 11.5, &yes));
  EXPECT_EQ(yes.last.a, Eigen::Vector2d(40, 50));
  EXPECT_EQ(yes.last.b, Eigen::Vector2d(51.5, 50));
  EXPECT_FALSE(joined(30, 11.5, &no));
  EXPECT_FALSE(joined(30, 11.5, nullptr));
  EXPECT_FALSE(joined(30, 12.5, &yes));
  EXPECT_TRUE(joined(20, 9.5, &yes));
  EXPECT_FALSE(joined(20, 10.5, &yes));
}

// Two pieces of a line are found in any direction, whichever comes first and whatever lies beside them.
TEST(CollinearMerger, FindsPiecesInEveryDirection) {
  const CollinearMergeParams params{0.1, 1.8, 4.0};
  CollinearMerger merger;
  for (int step = 0; step < 1024; ++step) {
    const double angle = degToRad(step * 360.0 / 1024.0);
    const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
    const double second = angle + (step % 2 == 0 ? 0.02 : -0.02);
    const Eigen::Vector2d onward(std::cos(second), std::sin(second));
    std::vector<GroupedSegment> pieces;
    for (int row = -20; row < 20; ++row) {
      const Eigen::Vector2d from = Eigen::Vector2d(300, 300) + 10.0 * row * turned90(way);
      const Eigen::Vector2d to = from + 40.0 * way;
      const Eigen::Vector2d next = to + 3.0 * way;
      pieces.push_back({{from, to}});
      pieces.insert(row % 2 == 0 ? pieces.begin() : pieces.end(), {{next, next + 30.0 * onward}});
    }
    merger.merge(pieces, params);
    EXPECT_EQ(pieces.size(), 40u) << "direction " << step;
  }
}

TEST(MergeSegments, KeepsApartWhatDoesNotBelongTogether) {
  const ImageSegment base = segment(0, 0, 30, 0);
  for (const ImageSegment& other :
       {segment(39, 0, 60, 0),                                           // gap of 9 px
        segment(35, 2, 60, 2),                                           // 2 px beside
        segment(60, 0, 35, 0),                                           // the other polarity
        segment(35, 0, 60, 0, "door"),                                   // another label
        segment(33, 0, 33 + 20 * std::cos(0.1), 20 * std::sin(0.1))}) {  // 0.1 rad off
    EXPECT_EQ(mergeSegments({base, other}, kParams).size(), 2u) << other.px.a.transpose();
  }
}

TEST(MergeSegments, WithItselfKeepsItsGeometry) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(0, 300);
  for (int i = 0; i < 200; ++i) {
    const ImageSegment one = segment(place(random), place(random), place(random), place(random));
    EXPECT_TRUE(near(mergeSegments({one, one}, kParams), {one}, 1e-6));
    EXPECT_TRUE(near(mergeSegments({one}, kParams), {one}, 1e-9));
  }
}

std::vector<ImageSegment> randomPieces(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(0, 320);
  std::uniform_real_distribution<double> gap(1, 12);
  std::normal_distribution<double> wobble(0, 0.3);
  std::vector<ImageSegment> pieces;
  for (int line = 0; line < 25; ++line) {
    const Eigen::Vector2d from(place(random), place(random));
    const double angle = place(random);
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    double at = 0.0;
    for (int piece = 0; piece < 4; ++piece) {
      const double length = 8.0 + gap(random);
      const Eigen::Vector2d side = wobble(random) * Eigen::Vector2d(-d.y(), d.x());
      const Eigen::Vector2d a = from + at * d + side;
      const Eigen::Vector2d b = from + (at + length) * d + side;
      pieces.push_back(segment(a.x(), a.y(), b.x(), b.y(), line % 3 == 0 ? "a" : "b"));
      at += length + gap(random);
    }
  }
  return pieces;
}

TEST(MergeSegments, DoesNotDependOnTheOrder) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    std::mt19937_64 random(seed);
    auto pieces = randomPieces(random);
    const auto expected = mergeSegments(pieces, kParams);
    EXPECT_LT(expected.size(), pieces.size());
    for (int i = 0; i < 5; ++i) {
      std::shuffle(pieces.begin(), pieces.end(), random);
      EXPECT_TRUE(near(mergeSegments(pieces, kParams), expected, 0.0)) << "seed " << seed;
    }
  }
}

TEST(MergeSegments, LeavesNothingToMergeAndCoversAllEnds) {
  for (const std::uint64_t seed : {6, 7, 8}) {
    std::mt19937_64 random(seed);
    const auto pieces = randomPieces(random);
    const auto merged = mergeSegments(pieces, kParams);
    EXPECT_EQ(mergeSegments(merged, kParams).size(), merged.size());
    for (const auto& piece : pieces) {
      for (const auto& end : {piece.px.a, piece.px.b}) {
        double nearest = 1e9;
        for (const auto& whole : merged) {
          if (whole.label == piece.label) nearest = std::min(nearest, distanceToSegment(end, whole.px));
        }
        EXPECT_LT(nearest, 2.5) << "seed " << seed;
      }
    }
  }
}

// The same criterion by looking at every pair: the grid must not miss any.
TEST(MergeSegments, TheGridMissesNoPair) {
  std::mt19937_64 random(10);
  std::uniform_real_distribution<double> place(-5000, 5000);
  std::uniform_real_distribution<double> small(0, 7.9);
  std::uniform_real_distribution<double> offset(-1.4, 1.4);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d from(place(random), place(random));
    const double angle = place(random);
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d side = offset(random) * Eigen::Vector2d(-d.y(), d.x());
    const Eigen::Vector2d b = from + 500 * d;
    const Eigen::Vector2d c = b + small(random) * d + side;
    const Eigen::Vector2d e = c + 12 * d;
    const auto merged = mergeSegments({segment(from.x(), from.y(), b.x(), b.y()),
                                       segment(c.x(), c.y(), e.x(), e.y()), segment(9000, 9000, 9001, 9000)},
                                      kParams);
    EXPECT_EQ(merged.size(), 2u);
  }
}

TEST(MergeSegments, TakesNothingAndPoints) {
  EXPECT_TRUE(mergeSegments({}, kParams).empty());
  EXPECT_TRUE(mergeSegments({segment(3, 3, 3, 3)}, kParams).empty());
}

}  // namespace
}  // namespace vismem
