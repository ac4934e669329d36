#include "localization/core/likelihood/camera_calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kLongestPause_s = 0.5;  // between two images whose difference is a motion
/// Weight of an image falls to 1/e after this number of images: a camera that is knocked is found again.
constexpr double kRemembered = 600.0;
/// Squared normalised error up to which the estimate may be noise.
constexpr double kByChance = 15.0;
/// Floor points farther away lie near the horizon of some perturbed view [m].
constexpr double kFarthest_m = 50.0;

/// Share of an image's evidence that is independent of the images before.
constexpr double kIndependent = 0.3;

/// Prior standard deviations: height, focal length, pitch, roll, delay.
const CameraVector kPrior{0.03, 0.03, degToRad(1.0), degToRad(1.0), 0.05};
/// Steps of the derivatives.
const CameraVector kStep{1e-4, 1e-4, 1e-4, 1e-4, 1e-3};

CameraMatrix priorInformation() {
  return kPrior.cwiseProduct(kPrior).cwiseInverse().asDiagonal();
}

}  // namespace

CameraCalibration::CameraCalibration() {
  errors_.P = kPrior.cwiseProduct(kPrior).asDiagonal();
}

void CameraCalibration::begin(const ImageAnalysis& analysis) {
  const double since_s = static_cast<double>(analysis.stamp_us - stamp_us_) / kSecondUs;
  T_odom_camera_before_ = T_odom_robot_ * stated_.T_robot_camera;
  since_before_s_ = since_s > 0.0 && since_s <= kLongestPause_s ? since_s : 0.0;
  stated_ = {analysis.intrinsics, analysis.T_robot_camera};
  T_odom_robot_ = toPose3(analysis.T_odom_robot);
  stamp_us_ = analysis.stamp_us;
}

CameraModel CameraCalibration::view(const CameraVector& errors) const {
  CameraModel view = stated_;
  if (since_before_s_ > 0.0) {
    const Pose3 T_odom_camera = T_odom_robot_ * stated_.T_robot_camera;
    const double back = errors[CameraErrors::kDelay] / since_before_s_;
    view.T_robot_camera = T_odom_robot_.inverse() * interpolate(T_odom_camera, T_odom_camera_before_, back);
  }
  view.T_robot_camera.translation().z() += errors[CameraErrors::kHeight];
  const Eigen::AngleAxisd pitch(errors[CameraErrors::kPitch], Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd roll(errors[CameraErrors::kRoll], Eigen::Vector3d::UnitX());
  view.T_robot_camera.linear() = pitch * roll * view.T_robot_camera.linear();
  view.intrinsics.fx *= 1.0 + errors[CameraErrors::kFocal];
  view.intrinsics.fy *= 1.0 + errors[CameraErrors::kFocal];
  return view;
}

CameraJacobian CameraCalibration::derivative(const Eigen::Vector2d& p_robot) const {
  CameraJacobian d = CameraJacobian::Zero();
  const CameraModel here = corrected();
  const auto px = projectToIdeal(
      here.intrinsics, here.T_robot_camera.inverse() * Eigen::Vector3d(p_robot.x(), p_robot.y(), 0.0));
  if (!px) return d;
  for (int i = 0; i < kStep.size(); ++i) {
    CameraVector errors = applied_;
    errors[i] += kStep[i];
    const CameraModel there = view(errors);
    const auto moved = backProjectToGround(there.intrinsics, there.T_robot_camera, *px, kFarthest_m);
    if (moved) d.col(i) = (moved->head<2>() - p_robot) / kStep[i];
  }
  return d;
}

void CameraCalibration::add(const CameraEvidence& evidence) {
  const double kept = 1.0 - 1.0 / kRemembered;
  information_ = kept * information_ + kIndependent * evidence.information;
  information_vector_ =
      kept * information_vector_ + kIndependent * (evidence.information * applied_ - evidence.gradient);
  const CameraMatrix all = information_ + priorInformation();
  errors_.P = all.inverse();
  errors_.errors = errors_.P * information_vector_;
  // Shrunk as by James and Stein, by more: images deviate alike. A camera without errors is not moved by
  // noise.
  const double chi2 = errors_.errors.dot(all * errors_.errors);
  applied_ =
      chi2 > kByChance ? CameraVector((1.0 - kByChance / chi2) * errors_.errors) : CameraVector::Zero();
}

std::string CameraAlarm::update(const CameraErrors& camera) {
  constexpr double kBegin = 3.0;
  constexpr double kEnd = 2.0;
  std::bitset<5> named;
  std::string text;
  for (std::size_t i = 0; i < kCameraErrorTexts.size(); ++i) {
    const auto row = static_cast<int>(i);
    const double sigma = std::sqrt(camera.P(row, row));
    named[i] = std::abs(camera.errors[row]) > (named_[i] ? kEnd : kBegin) * sigma;
    if (!named[i]) continue;
    const CameraErrorText& is = kCameraErrorTexts[i];
    char part[80];
    std::snprintf(part, sizeof part, "%s %.1f +- %.1f %s", is.name, is.scale * camera.errors[row],
                  is.scale * sigma, is.unit);
    text += (text.empty() ? "" : ", ") + std::string(part);
  }
  if (named == named_) return {};
  named_ = named;
  return text.empty() ? "the camera is as it is configured, as far as the map shows"
                      : "against the map: " + text + ": run calibrate body";
}

}  // namespace vismem
