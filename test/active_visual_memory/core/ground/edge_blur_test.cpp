// Tests M1.
#include "active_visual_memory/core/ground/edge_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace vismem {
namespace {

TEST(EdgeBlur, HalfWidthIsThatOfABlurredBar) {
  // The steepest places of a bar of half width h blurred by a Gaussian: where its slope's own slope is 0.
  const double sigma = 1.2;
  for (const double h : {0.3, 0.7, 1.2, 2.0, 4.0}) {
    const auto slope = [&](double x) {
      const auto g = [&](double d) { return std::exp(-0.5 * d * d / (sigma * sigma)); };
      return g(x + h) - g(x - h);
    };
    double steepest = 0.0;
    double least = 0.0;
    for (double x = 0.0; x < 8.0; x += 1e-4) {
      if (slope(x) < least) least = slope(x), steepest = x;
    }
    EXPECT_NEAR(trueHalfWidth(steepest, sigma), h, 0.02 + 0.1 * std::max(0.0, 1.0 - h)) << "h " << h;
  }
  EXPECT_EQ(trueHalfWidth(1.7, 0.0), 1.7);
  EXPECT_LT(trueHalfWidth(1.0, 1.2), 0.1) << "nearer than the blur allows: a line without width";
}

TEST(EdgeBlur, MovesBothEdgesOfANarrowLineInwardsAndNoOther) {
  const auto edge = [](double x1, double y1, double x2, double y2) {
    ImageSegment s;
    s.px = {{x1, y1}, {x2, y2}};
    s.strength = 50.0;
    return s;
  };
  const std::vector<ImageSegment> seen{
      edge(10, 100, 200, 100),      // upper edge of a narrow line
      edge(190, 102.6, 20, 102.6),  // its lower edge, the other way round
      edge(10, 150, 200, 150),      // alone
      edge(10, 153, 200, 153),      // beside it, of the same polarity
      edge(10, 200, 200, 200),      // a line of 12 pixels
      edge(200, 212, 10, 212),
  };
  const auto corrected = correctEdgeBlur(seen, {});
  ASSERT_EQ(corrected.size(), seen.size());
  EXPECT_GT(corrected[0].px.a.y(), 100.2);
  EXPECT_LT(corrected[1].px.a.y(), 102.4);
  EXPECT_NEAR(corrected[0].px.a.y() - 100.0, 102.6 - corrected[1].px.a.y(), 1e-9);
  EXPECT_LT(corrected[0].px.a.y(), corrected[1].px.a.y());
  for (std::size_t i = 2; i < seen.size(); ++i) {
    EXPECT_EQ(corrected[i].px.a, seen[i].px.a) << i;
    EXPECT_EQ(corrected[i].px.b, seen[i].px.b) << i;
  }
  EdgeBlurParams off;
  off.sigma_px = 0.0;
  EXPECT_EQ(correctEdgeBlur(seen, off)[0].px.a, seen[0].px.a);
}

}  // namespace
}  // namespace vismem
