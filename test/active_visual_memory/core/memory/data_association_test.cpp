// Tests V5.
#include "active_visual_memory/core/memory/data_association.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

using Observed = std::vector<ImageSegment>;
using Expected = std::vector<Expectation>;

ImageSegment seen(double x1, double y1, double x2, double y2, const Label& label = "edge") {
  return {{{x1, y1}, {x2, y2}}, label, 40.0};
}

Expectation expected(std::uint64_t id, double x1, double y1, double x2, double y2,
                     const Label& label = "edge") {
  return {{id, {{x1, y1}, {x2, y2}}, label}, 40.0};
}

TEST(Association, GivesTheThreeSetsOfFigure4) {
  // Observed 0 lies 2 px under expectation 0; observed 1 has no counterpart; expectation 1 has none either.
  const std::vector<ImageSegment> observed{seen(10, 102, 110, 102), seen(200, 20, 200, 80)};
  const std::vector<Expectation> memory{expected(7, 10, 100, 110, 100), expected(8, 10, 200, 110, 200)};
  const auto result = associate(observed, memory, {});
  ASSERT_EQ(result.matches.size(), 1u);
  EXPECT_EQ(result.matches[0].observed, 0);
  EXPECT_EQ(result.matches[0].predicted, 0);
  EXPECT_EQ(result.unobserved, std::pmr::vector<int>{1});
  EXPECT_EQ(result.unpredicted, std::pmr::vector<int>{1});
}

TEST(Association, IsOneToOneBestFirst) {
  const std::vector<ImageSegment> observed{seen(10, 102, 110, 102), seen(10, 100.5, 110, 100.5)};
  const std::vector<Expectation> memory{expected(1, 10, 100, 110, 100)};
  const auto result = associate(observed, memory, {});
  ASSERT_EQ(result.matches.size(), 1u);
  EXPECT_EQ(result.matches[0].observed, 1);
  // The other one lies on the same prediction: it supports it and is nothing new.
  ASSERT_EQ(result.supports.size(), 1u);
  EXPECT_EQ(result.supports[0].observed, 0);
  EXPECT_TRUE(result.unpredicted.empty());
}

TEST(Association, FragmentsOfOneLineSupportIt) {
  const std::vector<ImageSegment> observed{seen(10, 100, 50, 100), seen(60, 100, 110, 100)};
  const auto result = associate(observed, Expected{expected(1, 10, 100, 110, 100)}, {});
  EXPECT_EQ(result.matches.size() + result.supports.size(), 2u);
  EXPECT_TRUE(result.unpredicted.empty());
}

TEST(Association, AFragmentLiesInLineWithItsMatch) {
  // The prediction lies 6 px off, as with a tilted camera: the match shows where the line really is.
  const Expectation line = expected(1, 10, 100, 110, 100);
  const auto supports = [&](const ImageSegment& fragment) {
    const auto result = associate(Observed{seen(10, 106, 80, 106), fragment}, Expected{line}, {});
    EXPECT_EQ(result.matches.size(), 1u);
    EXPECT_EQ(result.supports.size() + result.unpredicted.size(), 1u);
    return result.supports.size() == 1;
  };
  EXPECT_TRUE(supports(seen(90, 106.5, 110, 107)));
  // The foot of a box beside the end of a marking: nearer to the prediction, but no piece of the same edge.
  EXPECT_FALSE(supports(seen(90, 100, 110, 100)));
  EXPECT_FALSE(supports(seen(20, 102.5, 70, 102.5))) << "an edge beside it";
  // It may still be a fragment of another prediction.
  const auto result =
      associate(Observed{seen(10, 100, 80, 100), seen(10, 95.5, 50, 95.5), seen(60, 96.1, 110, 96.1)},
                Expected{line, expected(2, 10, 92, 110, 92)}, {});
  ASSERT_EQ(result.matches.size(), 2u);
  ASSERT_EQ(result.supports.size(), 1u);
  EXPECT_EQ(result.supports[0].predicted, 1);
}

TEST(Association, GatesOnDistanceAngleOverlapLabelAndPolarity) {
  const auto matches = [](const ImageSegment& segment) {
    return !associate({&segment, 1}, std::vector{expected(1, 10, 100, 110, 100)}, {}).matches.empty();
  };
  EXPECT_TRUE(matches(seen(10, 107, 110, 107)));
  EXPECT_FALSE(matches(seen(10, 109, 110, 109))) << "9 px beside, gate 8 px";
  // Both ends 8.7 px off the middle over 100 px: atan(17.4 / 100) = 9.9 degrees, gate 8.
  EXPECT_FALSE(matches(seen(10, 91.3, 110, 108.7)));
  EXPECT_FALSE(matches(seen(90, 100, 190, 100))) << "20 of 100 px overlap, at least 30";
  EXPECT_FALSE(matches(seen(10, 100, 110, 100, "stripe")));
  EXPECT_TRUE(matches(seen(10, 100, 110, 100, kUnknownLabel)));
  EXPECT_FALSE(matches(seen(110, 100, 10, 100))) << "opposite polarity";
  ImageSegment faint = seen(110, 100, 10, 100);
  faint.strength = 1.0;
  EXPECT_TRUE(matches(faint)) << "an edge this faint does not know its polarity";
}

}  // namespace
}  // namespace vismem
