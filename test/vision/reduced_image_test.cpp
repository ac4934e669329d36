// Tests V1.
#include "common/vision/reduced_image.h"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

constexpr double kView_rad = std::numbers::pi / 3.0;

TEST(ReducedImage, BlocksLeaveAFocalLengthOf500Pixels) {
  for (const int width : {160, 320, 480, 640, 800, 1280, 1920, 3840}) {
    const CameraIntrinsics lens = intrinsicsFromFieldOfView(width, width * 3 / 4, kView_rad);
    const int block = blockSize(lens);
    const CameraIntrinsics small = reduced(lens, block);
    EXPECT_EQ(block == 1, lens.fx < 1000.0) << width;
    EXPECT_LT(small.fx, 1000.0) << width;
    if (block > 1) {
      EXPECT_GE(small.fx, 500.0) << width;
    }
    EXPECT_NEAR(small.cx, 0.5 * (small.width - 1), 0.5) << "the middle, but for columns that fill no block";
  }
  EXPECT_EQ(blockSize(intrinsicsFromFieldOfView(1280, 960, kView_rad * 1.6)), 1) << "a wide view has few pixels a degree";
}

TEST(ReducedImage, PointsStayWhereTheyAre) {
  // A size that the blocks do not fill, and a lens that bends.
  CameraIntrinsics lens = intrinsicsFromFieldOfView(1283, 725, kView_rad);
  lens.k1 = -0.2;
  const int block = blockSize(lens);
  ASSERT_EQ(block, 2);
  const CameraIntrinsics small = reduced(lens, block);
  cv::Mat image(lens.height, lens.width, CV_8UC1, cv::Scalar(0));
  const cv::Rect bright(600, 200, 80, 40);
  image(bright).setTo(200);
  cv::Mat out;
  reduceImage(image, lens, block, out);
  ASSERT_EQ(out.size(), cv::Size(small.width, small.height));
  const cv::Moments fine = cv::moments(image);
  const cv::Moments coarse = cv::moments(out);
  const Eigen::Vector2d at_fine(fine.m10 / fine.m00, fine.m01 / fine.m00);
  const Eigen::Vector2d at_coarse(coarse.m10 / coarse.m00, coarse.m01 / coarse.m00);
  const Eigen::Vector3d ray = idealPixelRay(lens, undistortPixel(lens, at_fine));
  EXPECT_NEAR((distortPixel(small, *projectToIdeal(small, ray)) - at_coarse).norm(), 0.0, 1e-3);
}

TEST(ReducedImage, ASizeThatIsNotThatOfTheLensIsRefused) {
  const CameraIntrinsics lens = intrinsicsFromFieldOfView(1280, 960, kView_rad);
  cv::Mat out;
  EXPECT_THROW(reduceImage(cv::Mat(480, 640, CV_8UC1), lens, 4, out), std::invalid_argument);
}

}  // namespace
}  // namespace vismem
