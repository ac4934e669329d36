// Brightness across a segment: position and strength of the edge.
// Tests V1.
#include "common/vision/line_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/vision/edge_points.h"
#include "common/vision/edge_sampling.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

Segment2 aside(const Segment2& px, double to_left_px) {
  const Eigen::Vector2d shift = to_left_px * leftNormal(px);
  return {px.a + shift, px.b + shift};
}

/// A square about the middle and its side on the right (as it lies before turning), bright on the left of its
/// way.
struct Scene {
  cv::Mat image;
  Segment2 edge;
};
Scene squareTurned(double angle_rad) {
  Scene scene{cv::Mat(120, 160, CV_8UC1, cv::Scalar(60)), {}};
  const Quad quad = squareAt({80.3, 60.2}, 60.0, angle_rad);
  fillQuad(scene.image, quad, cv::Scalar(140));
  blur(scene.image, 0.7);
  const Eigen::Vector2d d = (quad.corner[1] - quad.corner[2]).normalized();
  scene.edge = {quad.corner[2] + 8.0 * d, quad.corner[1] - 8.0 * d};
  const Eigen::Vector2d in = Eigen::Vector2d(80.3, 60.2) - scene.edge.middle();
  if (in.dot(leftNormal(scene.edge)) < 0.0) std::swap(scene.edge.a, scene.edge.b);
  return scene;
}

TEST(LineProfile, FindsAnEdgeBesideTheSegmentInAnyDirection) {
  for (int k = 0; k < 24; ++k) {
    const double angle = 0.27 * k;
    const Scene scene = squareTurned(angle);
    for (const double beside : {-0.25, -0.1, 0.0, 0.1, 0.25}) {
      const LineProfile found = profileAcross(scene.image, aside(scene.edge, -beside), 0.0);
      EXPECT_NEAR(found.aside_px, beside, 0.07) << angle;
      EXPECT_NEAR(found.step, 80.0, 6.0) << angle;
    }
    EXPECT_GT(profileAcross(scene.image, aside(scene.edge, -0.6), 0.0).aside_px, 0.35) << angle;
  }
}

TEST(LineProfile, ColourIsItsBrightnessAndTheOtherWayRoundTheStepFalls) {
  const Scene scene = squareTurned(0.4);
  cv::Mat colour;
  cv::cvtColor(scene.image, colour, cv::COLOR_GRAY2RGB);
  const LineProfile gray = profileAcross(scene.image, scene.edge, 0.0);
  const LineProfile rgb = profileAcross(colour, scene.edge, 0.0);
  EXPECT_DOUBLE_EQ(rgb.step, gray.step);
  EXPECT_DOUBLE_EQ(rgb.aside_px, gray.aside_px);
  const LineProfile back = profileAcross(scene.image, {scene.edge.b, scene.edge.a}, 0.0);
  EXPECT_NEAR(back.step, -gray.step, 1e-9);
}

// A bar of 1.5 px from column 19.5 to 21: smoothing puts its left edge further left than it is.
TEST(LineProfile, GivesBackWhatSmoothingMovesTheEdgesOfAThinBarApart) {
  cv::Mat image(40, 40, CV_8UC1, cv::Scalar(50));
  image.col(20) = 150;
  image.col(21) = 100;
  EdgePointFinder finder(bestEdgeRows());
  finder.find(image, 9.0, true);
  double left = 1e9;
  for (int i = 0; i < finder.count(); ++i) {
    const EdgePoint& point = finder.points()[i];
    left = std::min(left, point.column() + kEdgePointUnit_px * point.asideX());
  }
  EXPECT_LT(left, 19.3);
  const Segment2 edge{{left, 5.0},
                      {left, 35.0}};  // down: its left is the right of the picture, where it is bright
  const double moved = left + profileAcross(image, edge, 0.0).aside_px;
  EXPECT_NEAR(moved, 19.5, 0.12);
}

TEST(LineProfile, NoiseShrinksTheShift) {
  const Scene scene = squareTurned(0.4);
  const Segment2 beside = aside(scene.edge, -0.4);
  const double sure = profileAcross(scene.image, beside, 0.0).aside_px;
  const double unsure = profileAcross(scene.image, beside, 20.0).aside_px;
  EXPECT_GT(unsure, 0.0);
  EXPECT_LT(unsure, 0.9 * sure);
  EXPECT_NEAR(profileAcross(scene.image, beside, 1e6).aside_px, 0.0, 1e-3);
}

TEST(LineProfile, AtTheBorderTheNearestPixelCounts) {
  cv::Mat image(30, 50, CV_8UC1, cv::Scalar(50));
  image.colRange(0, 3) = 90;
  image.rowRange(0, 2) = 200;
  const LineProfile steep =
      profileAcross(image, {{2.5, 20.0}, {2.5, 4.0}}, 0.0);  // up: its left is that of the picture
  EXPECT_NEAR(steep.step, 40.0, 1e-9);
  EXPECT_NEAR(steep.aside_px, 0.0, 1e-9);
  const LineProfile flat = profileAcross(image, {{8.0, 1.5}, {49.0, 1.5}}, 0.0);
  EXPECT_NEAR(flat.step, 150.0, 1e-9);
  for (const Segment2& px : {Segment2{{0.0, 0.0}, {0.0, 29.0}}, Segment2{{49.0, 29.0}, {0.0, 29.0}}}) {
    EXPECT_TRUE(std::isfinite(profileAcross(image, px, 1.0).aside_px));
  }
}

}  // namespace
}  // namespace vismem
