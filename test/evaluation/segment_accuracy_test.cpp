// Tests V1.
#include "evaluation/core/segment_accuracy.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

TEST(MatchedPart, IsThePartBesideTheAnnotatedSegment) {
  // 2 px beside the line; the first 20 of its 80 px lie before it.
  const Segment2 annotated{{0, 0}, {100, 0}};
  const auto part = matchedPart({{-20, 2}, {60, 2}}, annotated, 2.5);
  ASSERT_TRUE(part);
  EXPECT_NEAR(part->begin, 0.25, 1e-12);
  EXPECT_NEAR(part->end, 1.0, 1e-12);
  EXPECT_FALSE(matchedPart({{-20, 2}, {60, 2}}, annotated, 1.5)) << "too far beside it";
  EXPECT_FALSE(matchedPart({{0, 0}, {50, 10}}, annotated, 20.0)) << "11.3 degrees";
}

TEST(LengthMatch, AnnotatedSegmentsBelowTenPixelsAreNotRecalled) {
  const std::vector<Segment2> annotated{{{0, 0}, {40, 0}}, {{0, 50}, {8, 50}}};
  const PrecisionRecall match = lengthMatch({{{0, 1}, {20, 1}}}, annotated, 2.0);
  EXPECT_NEAR(match.precision, 1.0, 1e-12);
  EXPECT_NEAR(match.recall, 0.5, 1e-12);
  EXPECT_NEAR(match.f(), 2.0 / 3.0, 1e-12);
}

TEST(ScoreImage, CountsFragmentsOfALineAndTheirOverlap) {
  // A line of 100 px in two pieces, of 60 and 50 px with 10 px in common.
  const ImageScore score = scoreImage({{{0, 0}, {60, 0}}, {{50, 1}, {100, 1}}}, {{{0, 0}, {100, 0}}});
  EXPECT_EQ(score.lines, 1);
  EXPECT_EQ(score.fragments, 2);
  EXPECT_NEAR(score.recalled_px, 100.0, 1e-9);
  EXPECT_NEAR(score.covering_px, 110.0, 1e-9);
  const AccuracySummary summary = summarize({score});
  EXPECT_NEAR(summary.fragments, 2.0, 1e-12);
  EXPECT_NEAR(summary.redundancy, 1.1, 1e-9);
}

TEST(ScoreImage, WithoutSegmentsIsZero) {
  const ImageScore score = scoreImage({}, {});
  EXPECT_EQ(score.at[1].precision, 0.0);
  EXPECT_EQ(score.at[1].recall, 0.0);
  EXPECT_EQ(summarize({}).segments, 0.0);
}

}  // namespace
}  // namespace vismem
