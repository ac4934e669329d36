// Tests L12: the camera's lasting errors are found against the map, by images of a camera that differs from
// the stated one.
#include "localization/core/likelihood/camera_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "common/geometry/angles.h"
#include "localization/core/localizer.h"
#include "localization/corridor_world.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

using testing::HasSubstr;

/// How the stated camera differs from the one that makes the images.
struct Misstated {
  double height_m = 0.0;  ///< true minus stated
  double focal_share = 0.0;
  double pitch_rad = 0.0;        ///< about the camera's x axis
  double mount_pitch_rad = 0.0;  ///< about the robot's y axis
  double delay_s = 0.0;
};

/// Motions of the head over time [rad].
struct Head {
  std::function<double(double)> pan = [](double t_s) { return degToRad(40.0) * std::sin(0.7 * t_s); };
  std::function<double(double)> tilt = [](double t_s) {
    return degToRad(-28.0 + 10.0 * std::sin(1.3 * t_s));
  };
};

/// A robot that knows its place drives along a corridor and looks around, at five images a second.
/// @param by_the_way_m largest distance from the true pose, if asked for.
CameraErrors errorsAfterDrive(const Misstated& by, const Head& head = {}, double* by_the_way_m = nullptr) {
  const SegmentMap map = test::corridorMap();
  Localizer localizer(localizerPreset(LocalizationMode::kDefault), map, 1);
  const auto& [pan, tilt] = head;
  const auto pose = [](double t_s) { return Pose2{1.0 + 0.05 * t_s, 0.1, 0.1 * std::sin(0.3 * t_s)}; };
  for (int i = 0; i < 400; ++i) {
    const double t_s = 0.2 * i;
    const StampUs stamp_us = 1 + toStampUs(t_s);
    MemoryUpdate update =
        test::viewFrom(map, pose(t_s - by.delay_s), stamp_us, pan(t_s - by.delay_s), tilt(t_s - by.delay_s));
    ImageAnalysis stated = *update.analysis;
    stated.T_robot_camera = test::emptyView(pan(t_s), tilt(t_s)).T_robot_camera;
    stated.T_robot_camera.translation().z() -= by.height_m;
    stated.T_robot_camera.linear() *=
        Eigen::AngleAxisd(-by.pitch_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
    stated.T_robot_camera.linear() =
        Eigen::AngleAxisd(-by.mount_pitch_rad, Eigen::Vector3d::UnitY()) * stated.T_robot_camera.linear();
    stated.intrinsics.fx /= 1.0 + by.focal_share;
    stated.intrinsics.fy /= 1.0 + by.focal_share;
    stated.T_odom_robot = pose(t_s);
    MemorySnapshot snapshot = *update.snapshot;
    snapshot.T_odom_robot = pose(t_s);
    update = {std::make_shared<const MemorySnapshot>(snapshot),
              std::make_shared<const ImageAnalysis>(stated)};
    localizer.update(update);
    if (i == 0) localizer.setPose(pose(t_s));
    const double error_m =
        (localizer.latest().T_world_robot.value().position() - pose(t_s).position()).norm();
    if (by_the_way_m) *by_the_way_m = std::max(*by_the_way_m, error_m);
  }
  return localizer.latest().camera.value();
}

TEST(CameraCalibration, FindsNothingInARightCamera) {
  const CameraErrors found = errorsAfterDrive({});
  EXPECT_NEAR(found.errors[CameraErrors::kHeight], 0.0, 0.003);
  EXPECT_NEAR(found.errors[CameraErrors::kFocal], 0.0, 0.005);
  EXPECT_NEAR(found.errors[CameraErrors::kDelay], 0.0, 0.005);
  EXPECT_EQ(CameraAlarm().update(found), "");
}

TEST(CameraCalibration, FindsAndNamesAWrongHeight) {
  const CameraErrors found = errorsAfterDrive({.height_m = 0.03});
  EXPECT_NEAR(found.errors[CameraErrors::kHeight], 0.03, 0.006);
  EXPECT_GT(0.03, 3.0 * found.sigmas[CameraErrors::kHeight]) << "certain";
  CameraAlarm alarm;
  EXPECT_THAT(alarm.update(found), HasSubstr("camera height error"));
  EXPECT_EQ(alarm.update(found), "") << "says it once";
  EXPECT_THAT(alarm.update(CameraErrors{}), HasSubstr("as it is configured"));
}

TEST(CameraCalibration, FindsAWrongFocalLength) {
  const CameraErrors found = errorsAfterDrive({.focal_share = 0.03});
  EXPECT_NEAR(found.errors[CameraErrors::kFocal], 0.03, 0.01);
}

TEST(CameraCalibration, FindsATiltedCameraAndNothingElse) {
  const CameraErrors found = errorsAfterDrive({.pitch_rad = degToRad(1.0)});
  EXPECT_NEAR(found.errors[CameraErrors::kPitch], degToRad(1.0), degToRad(0.15));
  EXPECT_TRUE(found.isFound(CameraErrors::kPitch));
  EXPECT_EQ(found.found.count(), 1);
}

TEST(CameraCalibration, KeepsThePoseWhileItLearnsATilt) {
  const auto isKept = [](const Misstated& by, CameraErrors::Error error, double pitch_rad) {
    double error_m = 0.0;
    const CameraErrors found = errorsAfterDrive(by, {}, &error_m);
    EXPECT_NEAR(found.errors[error], pitch_rad, degToRad(0.15));
    EXPECT_LT(error_m, 0.05) << radToDeg(pitch_rad) << " degrees: a tilt that is learnt does not count twice";
  };
  for (const double pitch_rad : {degToRad(-1.0), degToRad(1.0)}) {
    isKept({.pitch_rad = pitch_rad}, CameraErrors::kPitch, pitch_rad);
    isKept({.mount_pitch_rad = pitch_rad}, CameraErrors::kMountPitch, pitch_rad);
  }
}
TEST(CameraCalibration, NamesNeitherCameraNorMountAfterViewsInOneDirection) {
  // A head at rest that looks ahead: camera and mount turn it about the same axis.
  Head ahead;
  ahead.pan = [](double) { return 0.0; };
  const CameraErrors found = errorsAfterDrive({.pitch_rad = degToRad(1.0)}, ahead);
  EXPECT_FALSE(found.isFound(CameraErrors::kPitch));
  EXPECT_FALSE(found.isFound(CameraErrors::kMountPitch));
  EXPECT_NEAR(found.errors[CameraErrors::kPitch] - found.errors[CameraErrors::kMountPitch], degToRad(1.0),
              degToRad(0.15));
}

TEST(CameraCalibration, FindsLateImages) {
  const CameraErrors found = errorsAfterDrive({.delay_s = 0.05});
  EXPECT_NEAR(found.errors[CameraErrors::kDelay], 0.05, 0.01);
  EXPECT_THAT(CameraAlarm().update(found), HasSubstr("image delay"));
}

TEST(CameraCalibration, FindsLateImagesOfAHeadThatOnlyPans) {
  // From side to side in 0.4 s, and every two seconds.
  const auto pan = [](double t_s) {
    const double way = std::clamp(std::fmod(t_s, 2.0) / 0.4, 0.0, 1.0) - 0.5;
    return degToRad(40.0) * (std::fmod(t_s, 4.0) < 2.0 ? way : -way);
  };
  const auto tilt = [](double) { return degToRad(-28.0); };
  const CameraErrors found = errorsAfterDrive({.delay_s = 0.05}, {pan, tilt});
  EXPECT_NEAR(found.errors[CameraErrors::kDelay], 0.05, 0.005);
  EXPECT_TRUE(found.isFound(CameraErrors::kDelay));
}

}  // namespace
}  // namespace vismem
