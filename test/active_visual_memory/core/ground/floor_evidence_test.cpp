// Tests M4.
#include "active_visual_memory/core/ground/floor_evidence.h"

#include <gtest/gtest.h>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

const cv::Vec3b kGrass(40, 120, 40);
const cv::Vec3b kPaint(230, 230, 230);
const cv::Vec3b kRobot(60, 60, 160);

CameraIntrinsics camera() {
  return intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
}

/// Paint above row 120, grass below: the edge runs along y = 119.5, the brighter side on top.
cv::Mat edgeImage() {
  cv::Mat image(240, 320, CV_8UC3);
  image.setTo(cv::Scalar(kGrass[0], kGrass[1], kGrass[2]));
  image.rowRange(0, 120).setTo(cv::Scalar(kPaint[0], kPaint[1], kPaint[2]));
  return image;
}
cv::Mat uniform(const cv::Vec3b& c) {
  return cv::Mat(240, 320, CV_8UC3, cv::Scalar(c[0], c[1], c[2]));
}

// Bright on the left of a -> b: walking to the right of the picture, left is up.
const Segment2 kEdge{{60, 119.5}, {260, 119.5}};

TEST(FloorEvidence, KnowsTheColoursOfBothSides) {
  const FloorEvidence evidence(edgeImage(), camera(), {});
  const auto sides = evidence.sides(kEdge);
  ASSERT_TRUE(sides);
  EXPECT_NEAR(sides->left.y(), 230, 1);
  EXPECT_NEAR(sides->right.y(), 120, 1);
}

TEST(FloorEvidence, DistinguishesFreeOccludedAndPresent) {
  const auto sides = FloorEvidence(edgeImage(), camera(), {}).sides(kEdge);
  ASSERT_TRUE(sides);
  EXPECT_EQ(FloorEvidence(uniform(kGrass), camera(), {}).classify(kEdge, *sides), PlaceShows::kFree);
  EXPECT_EQ(FloorEvidence(uniform(kRobot), camera(), {}).classify(kEdge, *sides), PlaceShows::kOccluded);
  EXPECT_EQ(FloorEvidence(edgeImage(), camera(), {}).classify(kEdge, *sides), PlaceShows::kOccluded);
}

TEST(FloorEvidence, DistinguishesAHiddenEndFromACorner) {
  // A robot stands where the edge ends: it covers both of its sides.
  cv::Mat hidden = edgeImage();
  hidden(cv::Rect(200, 60, 60, 150)).setTo(cv::Scalar(kRobot[0], kRobot[1], kRobot[2]));
  const Segment2 up_to_robot{{60, 119.5}, {198, 119.5}};
  EXPECT_TRUE(FloorEvidence(hidden, camera(), {}).isHiddenBeyond(up_to_robot, true));
  EXPECT_FALSE(FloorEvidence(hidden, camera(), {}).isHiddenBeyond(up_to_robot, false));
  // The paint ends: beyond its corner is grass, as on its other side.
  cv::Mat corner = edgeImage();
  corner(cv::Rect(200, 0, 120, 120)).setTo(cv::Scalar(kGrass[0], kGrass[1], kGrass[2]));
  EXPECT_FALSE(FloorEvidence(corner, camera(), {}).isHiddenBeyond(up_to_robot, true));
  // A thing that begins at the edge and stands on its far side hides nothing of it.
  cv::Mat behind = edgeImage();
  behind(cv::Rect(200, 0, 60, 120)).setTo(cv::Scalar(kRobot[0], kRobot[1], kRobot[2]));
  EXPECT_FALSE(FloorEvidence(behind, camera(), {}).isHiddenBeyond(up_to_robot, true));
  EXPECT_FALSE(FloorEvidence(edgeImage(), camera(), {}).isHiddenBeyond({{60, 119.5}, {318, 119.5}}, true))
      << "nothing is seen beyond the image";
}

TEST(FloorEvidence, ABlackImageProvesNothingGone) {
  const auto sides = FloorEvidence(edgeImage(), camera(), {}).sides(kEdge);
  EXPECT_EQ(FloorEvidence(uniform({0, 0, 0}), camera(), {}).classify(kEdge, *sides), PlaceShows::kOccluded);
}

TEST(FloorEvidence, IsUnknownWithoutAnImageAndOutsideIt) {
  EXPECT_EQ(FloorEvidence({}, camera(), {}).classify(kEdge, {}), PlaceShows::kUnknown);
  EXPECT_FALSE(FloorEvidence({}, camera(), {}).sides(kEdge));
  const Segment2 outside{{400, 10}, {500, 10}};
  EXPECT_EQ(FloorEvidence(edgeImage(), camera(), {}).classify(outside, {}), PlaceShows::kUnknown);
}

}  // namespace
}  // namespace vismem
