#include "active_visual_memory/core/floor_evidence.h"

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

TEST(FloorEvidence, TellsBareFromCoveredFromStillThere) {
  const auto sides = FloorEvidence(edgeImage(), camera(), {}).sides(kEdge);
  ASSERT_TRUE(sides);
  EXPECT_EQ(FloorEvidence(uniform(kGrass), camera(), {}).look(kEdge, *sides), PlaceShows::kBare);
  EXPECT_EQ(FloorEvidence(uniform(kRobot), camera(), {}).look(kEdge, *sides), PlaceShows::kSomething);
  EXPECT_EQ(FloorEvidence(edgeImage(), camera(), {}).look(kEdge, *sides), PlaceShows::kSomething);
}

TEST(FloorEvidence, ABlackImageProvesNothingGone) {
  const auto sides = FloorEvidence(edgeImage(), camera(), {}).sides(kEdge);
  EXPECT_EQ(FloorEvidence(uniform({0, 0, 0}), camera(), {}).look(kEdge, *sides), PlaceShows::kSomething);
}

TEST(FloorEvidence, SaysNothingWithoutAnImageOrOutsideIt) {
  EXPECT_EQ(FloorEvidence({}, camera(), {}).look(kEdge, {}), PlaceShows::kUnknown);
  EXPECT_FALSE(FloorEvidence({}, camera(), {}).sides(kEdge));
  const Segment2 outside{{400, 10}, {500, 10}};
  EXPECT_EQ(FloorEvidence(edgeImage(), camera(), {}).look(outside, {}), PlaceShows::kUnknown);
}

}  // namespace
}  // namespace vismem
