/// @file The lens as a vector of unknowns, and the models to choose from. Pure.
/// Brown-Conrady as in common/geometry/camera.h, written for automatic derivatives.
#pragma once

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <array>
#include <string>

#include "calibration/core/board.h"
#include "common/geometry/camera.h"

namespace vismem {

/// Each frees the parameters of the one before and some more.
enum class LensModel {
  kPinhole,     ///< fx fy cx cy
  kRadial,      ///< + k1 k2
  kTangential,  ///< + p1 p2
  kFull,        ///< + k3
};
inline constexpr std::array<LensModel, 4> kLensModels{LensModel::kPinhole, LensModel::kRadial,
                                                      LensModel::kTangential, LensModel::kFull};

/// Names for reports: "f", "f k1 k2", "f k1 k2 p1 p2", "f k1 k2 p1 p2 k3".
std::string nameOf(LensModel model);
/// The first so many entries of a LensVector are free, the others are 0.
int freeParameters(LensModel model);

/// fx fy cx cy [px] k1 k2 p1 p2 k3.
inline constexpr int kLensParameters = 9;
using LensVector = Eigen::Matrix<double, kLensParameters, 1>;
using LensMatrix = Eigen::Matrix<double, kLensParameters, kLensParameters>;

LensVector lensVector(const CameraIntrinsics& lens);
CameraIntrinsics lensFrom(const LensVector& vector, int width, int height);

/// Height of a bent board at a place: bow.x() (1 - x^2) + bow.y() (1 - y^2), x and y in -1..1 over its
/// corners [m].
template <typename T>
T boardHeight(const BoardSpec& board, const Eigen::Vector3d& p_board, const T* bow) {
  const double x = 2.0 * p_board.x() / (board.columns * board.square_m.x()) - 1.0;
  const double y = 2.0 * p_board.y() / (board.rows * board.square_m.y()) - 1.0;
  return bow[0] * (1.0 - x * x) + bow[1] * (1.0 - y * y);
}

/// Raw pixel of a point in the camera's frame, z > 0.
/// @param lens a LensVector's entries; @param p 3 numbers; @param px 2 numbers.
template <typename T>
void projectThroughLens(const T* lens, const T* p, T* px) {
  const T x = p[0] / p[2];
  const T y = p[1] / p[2];
  const T r2 = x * x + y * y;
  const T radial = 1.0 + r2 * (lens[4] + r2 * (lens[5] + r2 * lens[8]));
  px[0] = lens[0] * (x * radial + 2.0 * lens[6] * x * y + lens[7] * (r2 + 2.0 * x * x)) + lens[2];
  px[1] = lens[1] * (y * radial + lens[6] * (r2 + 2.0 * y * y) + 2.0 * lens[7] * x * y) + lens[3];
}

/// Residual of one corner over its sigma. Blocks: lens (9), pose of the board in the camera's frame
/// (angle-axis, translation), bow (2).
struct CornerError {
  Eigen::Vector3d p_board;
  Eigen::Vector2d px;
  double sigma_px = 1.0;
  const BoardSpec* board = nullptr;

  template <typename T>
  bool operator()(const T* lens, const T* pose, const T* bow, T* residual) const {
    const T bent[3] = {T(p_board.x()), T(p_board.y()), boardHeight(*board, p_board, bow)};
    T p[3];
    ceres::AngleAxisRotatePoint(pose, bent, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    projectThroughLens(lens, p, residual);
    for (int i = 0; i < 2; ++i) residual[i] = (residual[i] - px[i]) / sigma_px;
    return true;
  }
};

}  // namespace vismem
