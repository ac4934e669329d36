#include "evaluation/core/perturbation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

using testing::HasSubstr;

Perturbation parsed(const std::string& text) {
  const ParsedPerturbation result = parsePerturbation(text);
  EXPECT_EQ(result.error, "");
  return result.perturbation;
}

/// A white bar of one pixel on grey, seen by a camera that looks along the robot's x axis.
Frame bar() {
  Frame frame;
  frame.stamp_us = kSecondUs;
  frame.seq = 4;
  frame.image = cv::Mat(20, 30, CV_8UC3, cv::Scalar(100, 100, 100));
  frame.image.col(15).setTo(cv::Scalar(220, 220, 220));
  frame.intrinsics = intrinsicsFromFieldOfView(30, 20, 1.0);
  frame.T_robot_camera = poseFromXyzRpy(0.1, 0.0, 0.5, -0.5 * M_PI, 0.0, -0.5 * M_PI);
  return frame;
}

TEST(Perturbation, NothingIsChangedByDefault) {
  const Frame frame = bar();
  const Frame same = perturbed(parsed(""), frame);
  EXPECT_EQ(same.stamp_us, frame.stamp_us);
  EXPECT_EQ(same.intrinsics, frame.intrinsics);
  EXPECT_TRUE(same.T_robot_camera->isApprox(*frame.T_robot_camera));
  EXPECT_EQ(cv::norm(same.image, frame.image, cv::NORM_INF), 0.0);
}

TEST(Perturbation, StatesACameraHigherAndTiltedUp) {
  const Frame frame = bar();
  const Frame moved = perturbed(parsed("height=0.02,tilt=1"), frame);
  EXPECT_NEAR(moved.T_robot_camera->translation().z(), 0.52, 1e-12);
  EXPECT_NEAR(moved.T_robot_camera->translation().x(), 0.1, 1e-12);
  const Eigen::Vector3d axis = moved.T_robot_camera->linear() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::asin(axis.z()), degToRad(1.0), 1e-9) << "it looks up";
  EXPECT_NEAR(axis.y(), 0.0, 1e-12);
}

TEST(Perturbation, ChangesFocalLengthStampAndLight) {
  const Frame frame = bar();
  const Frame changed = perturbed(parsed("focal=1.02,late=0.05,brightness=1.5"), frame);
  EXPECT_NEAR(changed.intrinsics.fx, 1.02 * frame.intrinsics.fx, 1e-9);
  EXPECT_NEAR(changed.intrinsics.fy, 1.02 * frame.intrinsics.fy, 1e-9);
  EXPECT_EQ(changed.stamp_us, frame.stamp_us + 50'000);
  EXPECT_EQ(changed.image.at<cv::Vec3b>(10, 3), cv::Vec3b(150, 150, 150));
  EXPECT_EQ(changed.image.at<cv::Vec3b>(10, 15), cv::Vec3b(255, 255, 255)) << "saturates";
  EXPECT_EQ(frame.image.at<cv::Vec3b>(10, 3), cv::Vec3b(100, 100, 100)) << "the source's pixels are shared";
}

TEST(Perturbation, ChangesTheColourOfTheLight) {
  const Eigen::Vector3d warm = whiteBalanceFactors(3000.0);
  // Planck at 3000 K over 6500 K: 0.01422, 0.0089, 0.003795; relative to green, encoded by 1/2.2.
  EXPECT_NEAR(warm[0], std::pow(0.01422 / 0.0089, 1 / 2.2), 0.005);
  EXPECT_DOUBLE_EQ(warm[1], 1.0);
  EXPECT_NEAR(warm[2], std::pow(0.003795 / 0.0089, 1 / 2.2), 0.005);
  EXPECT_TRUE(whiteBalanceFactors(6500.0).isApprox(Eigen::Vector3d::Ones()));
  const Frame lit = perturbed(parsed("white=3000"), bar());
  const cv::Vec3b pixel = lit.image.at<cv::Vec3b>(10, 3);
  EXPECT_NEAR(pixel[0], 100 * warm[0], 0.51);
  EXPECT_EQ(pixel[1], 100);
  EXPECT_NEAR(pixel[2], 100 * warm[2], 0.51);
}

TEST(Perturbation, BendsTheEncodingAndDarkensTheCorners) {
  const Frame bent = perturbed(parsed("gamma=1.4"), bar());
  EXPECT_EQ(bent.image.at<cv::Vec3b>(10, 3)[0], std::lround(255 * std::pow(100 / 255.0, 1.4)));
  const Frame dark = perturbed(parsed("vignette=0.5"), bar());
  EXPECT_NEAR(dark.image.at<cv::Vec3b>(0, 0)[0], 50, 0.51);
  EXPECT_NEAR(dark.image.at<cv::Vec3b>(10, 13)[0], 100, 1.0);
}

TEST(Perturbation, AddsTheSameNoiseToTheSameFrame) {
  Frame frame = bar();
  const cv::Mat noisy = perturbed(parsed("noise=10"), frame).image;
  EXPECT_EQ(cv::norm(noisy, perturbed(parsed("noise=10"), frame).image, cv::NORM_INF), 0.0);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(noisy.colRange(0, 14), mean, deviation);
  EXPECT_NEAR(mean[1], 100.0, 2.5);
  EXPECT_NEAR(deviation[1], 10.0, 1.5);
  frame.seq = 5;
  EXPECT_GT(cv::norm(noisy, perturbed(parsed("noise=10"), frame).image, cv::NORM_INF), 5.0);
}

TEST(Perturbation, ScalesImageAndIntrinsicsAlike) {
  const Frame frame = bar();
  const Frame twice = perturbed(parsed("scale=2"), frame);
  EXPECT_EQ(twice.image.size(), cv::Size(60, 40));
  EXPECT_EQ(twice.intrinsics.width, 60);
  EXPECT_EQ(twice.intrinsics.height, 40);
  EXPECT_NEAR(twice.intrinsics.fx, 2.0 * frame.intrinsics.fx, 1e-9);
  EXPECT_NEAR(twice.intrinsics.cx, 29.5, 1e-9);  // still the middle
  EXPECT_GT(twice.image.at<cv::Vec3b>(10, 31)[0], 180) << "the bar lies between columns 30 and 31";
}

TEST(Perturbation, BlursAlongRows) {
  const Frame blurred = perturbed(parsed("blur=3"), bar());
  for (int column = 14; column <= 16; ++column) {
    EXPECT_NEAR(blurred.image.at<cv::Vec3b>(10, column)[0], 140, 1) << column;
  }
  EXPECT_EQ(blurred.image.at<cv::Vec3b>(10, 12)[0], 100);
}

TEST(Perturbation, CompressesWithLoss) {
  const Frame frame = bar();
  const Frame coarse = perturbed(parsed("jpeg=10"), frame);
  ASSERT_EQ(coarse.image.size(), frame.image.size());
  EXPECT_GT(cv::norm(coarse.image, frame.image, cv::NORM_INF), 5.0);
  EXPECT_LT(cv::norm(coarse.image, frame.image, cv::NORM_L1) / static_cast<double>(frame.image.total()),
            30.0);
}

TEST(Perturbation, LosesAllButEachNth) {
  Frame frame = bar();
  const Perturbation half = parsed("every=2");
  EXPECT_TRUE(arrives(half, frame));
  frame.seq = 5;
  EXPECT_FALSE(arrives(half, frame));
  EXPECT_TRUE(arrives(parsed(""), frame));
}

TEST(Perturbation, APoseThatTheFrameLacksCannotBeChanged) {
  Frame frame = bar();
  frame.T_robot_camera.reset();
  EXPECT_THROW(perturbed(parsed("tilt=1"), frame), std::invalid_argument);
  EXPECT_NO_THROW(perturbed(parsed("blur=3"), frame));
}

TEST(Perturbation, WrongTextsAreRefusedWithWhatWasExpected) {
  EXPECT_THAT(parsePerturbation("hight=1").error, HasSubstr("did you mean \"height\"?"));
  EXPECT_THAT(parsePerturbation("tilt").error, HasSubstr("expected a number from -45 to 45"));
  EXPECT_THAT(parsePerturbation("jpeg=50.5").error, HasSubstr("expected a whole number from 1 to 100"));
  EXPECT_THAT(parsePerturbation("tilt=nan").error, HasSubstr("tilt=nan"));
  EXPECT_THAT(parsePerturbation("tilt=1x").error, HasSubstr("tilt=1x"));
  EXPECT_THAT(parsePerturbation("blur=3,blur=3").error, HasSubstr("blur twice"));
}

TEST(PerturbedOdometry, ScalesTheWayAndTurnsWithTime) {
  PerturbedOdometry odometry(parsePerturbation("way=1.1,drift=60").perturbation);
  const auto at = [&](double s, double x) {
    OdometrySample sample;
    sample.stamp_us = toStampUs(s);
    sample.T_odom_robot = {x, 0.0, 0.0};
    return odometry.next(sample).T_odom_robot;
  };
  EXPECT_DOUBLE_EQ(at(0.0, 5.0).x, 5.0) << "the first sample stays";
  EXPECT_NEAR(at(0.1, 6.0).x, 6.1, 1e-9);
  const Pose2 end = at(1.0, 6.0);
  EXPECT_NEAR(end.x, 6.1, 1e-9);
  EXPECT_NEAR(end.theta, degToRad(1.0), 1e-9) << "one degree a second";
}

}  // namespace
}  // namespace vismem
