#include "calibration/core/lens/projection_grid.h"

#include <ceres/jet.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

constexpr int kTurn = 3;
using Jet = ceres::Jet<double, kLensParameters + kTurn>;

/// Pixel of a direction through a lens, with derivatives by the lens and by a small turn of the direction.
struct Projected {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, kLensParameters> J_lens;
  Eigen::Matrix<double, 2, kTurn> J_turn;
};

Projected project(const LensVector& lens, const Eigen::Vector3d& ray) {
  Jet unknowns[kLensParameters];
  for (int i = 0; i < kLensParameters; ++i) unknowns[i] = Jet(lens[i], i);
  Jet w[kTurn];
  for (int i = 0; i < kTurn; ++i) w[i] = Jet(0.0, kLensParameters + i);
  const Jet p[3] = {ray.x() + (w[1] * ray.z() - w[2] * ray.y()), ray.y() + (w[2] * ray.x() - w[0] * ray.z()),
                    ray.z() + (w[0] * ray.y() - w[1] * ray.x())};
  Jet px[2];
  projectThroughLens(unknowns, p, px);
  Projected result;
  for (int i = 0; i < 2; ++i) {
    result.px[i] = px[i].a;
    result.J_lens.row(i) = px[i].v.head<kLensParameters>().transpose();
    result.J_turn.row(i) = px[i].v.tail<kTurn>().transpose();
  }
  return result;
}

std::vector<Eigen::Vector3d> raysOf(const CameraIntrinsics& lens, const PixelGrid& grid) {
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& px : grid.px) rays.push_back(idealPixelRay(lens, undistortPixel(lens, px)));
  return rays;
}

}  // namespace

PixelGrid pixelGrid(int width, int height, int columns, int rows) {
  PixelGrid grid{columns, rows, {}};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      grid.px.emplace_back((width - 1.0) * column / (columns - 1), (height - 1.0) * row / (rows - 1));
    }
  }
  return grid;
}

ProjectionUncertainty projectionUncertainty(const CameraIntrinsics& lens, const LensMatrix& P,
                                            const PixelGrid& grid) {
  const auto rays = raysOf(lens, grid);
  const LensVector vector = lensVector(lens);
  const auto count = static_cast<Eigen::Index>(rays.size());
  Eigen::MatrixXd J(2 * count, kLensParameters);
  Eigen::MatrixXd turn(2 * count, kTurn);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Projected one = project(vector, rays[static_cast<std::size_t>(i)]);
    J.middleRows<2>(2 * i) = one.J_lens;
    turn.middleRows<2>(2 * i) = one.J_turn;
  }
  J -= turn * (turn.transpose() * turn).ldlt().solve(turn.transpose() * J);
  ProjectionUncertainty result;
  result.grid = grid;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Matrix2d P_px = J.middleRows<2>(2 * i) * P * J.middleRows<2>(2 * i).transpose();
    result.P_px.push_back(P_px);
    result.sigma_px.push_back(
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(P_px).eigenvalues().maxCoeff()));
  }
  result.worst = static_cast<std::size_t>(std::max_element(result.sigma_px.begin(), result.sigma_px.end()) -
                                          result.sigma_px.begin());
  return result;
}

ProjectionDifference projectionDifference(const CameraIntrinsics& first, const CameraIntrinsics& second,
                                          const PixelGrid& grid, bool is_turn_free) {
  auto rays = raysOf(first, grid);
  const LensVector vector = lensVector(second);
  constexpr int kIterations = 6;
  for (int iteration = 0; is_turn_free && iteration < kIterations; ++iteration) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Projected one = project(vector, rays[i]);
      H += one.J_turn.transpose() * one.J_turn;
      g += one.J_turn.transpose() * (one.px - grid.px[i]);
    }
    const Eigen::Vector3d w = -H.ldlt().solve(g);
    if (w.norm() < 1e-12) break;
    const Eigen::Matrix3d R = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
    for (Eigen::Vector3d& ray : rays) ray = R * ray;
  }
  ProjectionDifference result;
  result.grid = grid;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    result.difference_px.push_back(project(vector, rays[i]).px - grid.px[i]);
    lengths.push_back(result.difference_px.back().norm());
  }
  std::sort(lengths.begin(), lengths.end());
  result.worst_px = lengths.back();
  result.p90_px = lengths[static_cast<std::size_t>(0.9 * static_cast<double>(lengths.size() - 1))];
  return result;
}

double horizontalView_rad(const CameraIntrinsics& lens) {
  const double row = 0.5 * (lens.height - 1);
  const Eigen::Vector3d left = idealPixelRay(lens, undistortPixel(lens, {0.0, row}));
  const Eigen::Vector3d right = idealPixelRay(lens, undistortPixel(lens, {lens.width - 1.0, row}));
  return std::acos(std::clamp(left.normalized().dot(right.normalized()), -1.0, 1.0));
}

}  // namespace vismem
