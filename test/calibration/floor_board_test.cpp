/// @file Real paper and a real lens: one image of a board on the floor against OpenCV's perspective-n-point.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/core/body/body_estimator.h"
#include "camera_server/core/camera_info.h"
#include "common/config/text_file.h"
#include "common/geometry/angles.h"
#include "support/data_folder.h"

namespace vismem {
namespace {

constexpr double kSquare_m = 0.031;
const cv::Size kCorners(7, 5);

struct FloorBoard {
  CameraIntrinsics intrinsics;
  BodyRecord record;
  double height_m = 0.0;  ///< by perspective-n-point
  double tilt_rad = 0.0;
};

/// Corners with the board's y up; OpenCV numbers them with y down.
std::vector<BoardCorner> cornersOf(const BoardSpec& board, const std::vector<cv::Point2f>& pixels) {
  std::vector<BoardCorner> corners;
  for (int row = 0; row < kCorners.height; ++row) {
    for (int column = 0; column < kCorners.width; ++column) {
      const cv::Point2f& p = pixels[static_cast<std::size_t>(row * kCorners.width + column)];
      corners.push_back({board.cornerId(column, kCorners.height - 1 - row), {p.x, p.y}, 0.25});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return corners;
}

void perspectiveNPoint(FloorBoard& floor) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const BoardCorner& corner : floor.record.views.front().corners) {
    const Eigen::Vector3d p = cornerPosition(floor.record.board, corner.id);
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(corner.pixel.x(), corner.pixel.y());
  }
  const CameraIntrinsics& k = floor.intrinsics;
  const cv::Matx33d K(k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1);
  const cv::Vec<double, 5> d(k.k1, k.k2, k.p1, k.p2, k.k3);
  cv::Vec3d rotation;
  cv::Vec3d translation;
  cv::solvePnP(points, pixels, K, d, rotation, translation);
  cv::Matx33d R;
  cv::Rodrigues(rotation, R);
  const cv::Vec3d centre = -(R.t() * translation);  // of the camera, in the board's frame
  floor.height_m = centre[2];
  floor.tilt_rad = std::asin(R(2, 2));  // the camera's axis against the board's plane
}

std::optional<FloorBoard> load() {
  const std::filesystem::path folder = dataFolder() / "floor_board";
  if (!std::filesystem::exists(folder)) return std::nullopt;
  FloorBoard floor;
  const std::filesystem::path lens = folder / "camera_info.yaml";
  floor.intrinsics = parseCameraInfo(readTextFile(lens, "a calibration"), lens.string());
  const cv::Mat image = cv::imread((folder / "20cm.png").string(), cv::IMREAD_GRAYSCALE);
  std::vector<cv::Point2f> pixels;
  if (!cv::findChessboardCorners(image, kCorners, pixels)) return floor;
  cv::cornerSubPix(image, pixels, {5, 5}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-3});
  BodyRecord& record = floor.record;
  record.board.columns = kCorners.width + 1;
  record.board.rows = kCorners.height + 1;
  record.board.square_m = {kSquare_m, kSquare_m};
  record.intrinsics = floor.intrinsics;
  record.views.push_back({1'000'000, cornersOf(record.board, pixels)});
  for (std::int64_t stamp : {0, 2'000'000}) {
    record.joints.push_back({stamp, 0, 0.0, 0.0});
    record.odometry.push_back({stamp, 0, {}, 0.0, 0.0});
  }
  perspectiveNPoint(floor);
  return floor;
}

TEST(FloorBoard, HeightAndTiltAgreeWithPerspectiveNPoint) {
  const auto floor = load();
  if (!floor) GTEST_SKIP() << "floor_board is not here";
  ASSERT_EQ(floor->record.views.size(), 1U) << "no chessboard was found";
  ASSERT_GT(floor->height_m, 0.0) << "the camera is above the floor";
  BodyEstimatorParams params;
  // As described: 5 cm too high, 10 degrees too little tilt.
  params.mount.T_robot_pantilt = poseFromXyzRpy(0.0, 0.0, 0.27, 0.0, 0.0, 0.0);
  params.mount.T_head_camera_body = poseFromXyzRpy(0.0, 0.0, 0.0, 0.0, degToRad(42.0), 0.0);
  // Perspective-n-point takes the whole lens as exact.
  params.focal_sigma_px = params.centre_sigma_px = params.distortion_sigma_px = 0.0;
  const BodyEstimate estimate = estimateBody(floor->record, params);
  ASSERT_TRUE(estimate.place[2].sigma);
  ASSERT_TRUE(estimate.place[4].sigma);
  EXPECT_NEAR(estimate.place[2].value, floor->height_m, 0.003);
  EXPECT_NEAR(radToDeg(estimate.place[4].value), radToDeg(floor->tilt_rad), 0.3);
  std::cout << "height " << 1e3 * estimate.place[2].value << " mm, by perspective-n-point "
            << 1e3 * floor->height_m << "; tilt " << radToDeg(estimate.place[4].value) << " degrees, "
            << radToDeg(floor->tilt_rad) << "; corners " << estimate.fit.rms_px << " px RMS\n";
  // One image cannot show the rest.
  EXPECT_FALSE(estimate.place[0].sigma);
  EXPECT_FALSE(estimate.place[5].sigma);
  EXPECT_FALSE(estimate.isObservable(kPanScale));
  EXPECT_FALSE(estimate.isObservable(kUnitZ)) << "only its sum with the camera's height on the head";
}

}  // namespace
}  // namespace vismem
