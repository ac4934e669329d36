#include "calibration/core/lens/board_pose.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

namespace vismem {
namespace {

/// Moves points to mean 0 and mean distance sqrt(2).
Eigen::Matrix3d normaliser(const Eigen::Matrix2Xd& points) {
  const Eigen::Vector2d mean = points.rowwise().mean();
  const double distance = (points.colwise() - mean).colwise().norm().mean();
  Eigen::Matrix3d N = Eigen::Matrix3d::Identity();
  N.diagonal().head<2>().setConstant(std::sqrt(2.0) / std::max(distance, 1e-12));
  N.topRightCorner<2, 1>() = -N(0, 0) * mean;
  return N;
}

/// @return H with to ~ H from; empty for points on one line.
std::optional<Eigen::Matrix3d> homography(const Eigen::Matrix2Xd& from, const Eigen::Matrix2Xd& to) {
  const Eigen::Matrix3d N_from = normaliser(from);
  const Eigen::Matrix3d N_to = normaliser(to);
  Eigen::MatrixXd A(2 * from.cols(), 9);
  for (Eigen::Index i = 0; i < from.cols(); ++i) {
    const Eigen::Vector3d p = N_from * from.col(i).homogeneous();
    const Eigen::Vector3d q = N_to * to.col(i).homogeneous();
    A.row(2 * i) << p.transpose(), 0, 0, 0, -q.x() * p.transpose();
    A.row(2 * i + 1) << 0, 0, 0, p.transpose(), -q.y() * p.transpose();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  // Rank 8 of 9, or the points do not determine it.
  if (svd.singularValues()(7) < 1e-3 * svd.singularValues()(0)) return std::nullopt;
  const Eigen::VectorXd h = svd.matrixV().col(8);
  const Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  return N_to.inverse() * H * N_from;
}

}  // namespace

std::optional<Pose3> boardPoseFrom(const CameraIntrinsics& lens, const BoardSpec& board,
                                   const BoardView& view) {
  const auto count = static_cast<Eigen::Index>(view.corners.size());
  if (count < 4) return std::nullopt;
  Eigen::Matrix2Xd on_board(2, count);
  Eigen::Matrix2Xd rays(2, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const BoardCorner& corner = view.corners[static_cast<std::size_t>(i)];
    on_board.col(i) = cornerPosition(board, corner.id).head<2>();
    rays.col(i) = idealPixelRay(lens, undistortPixel(lens, corner.pixel)).head<2>();
  }
  const auto found = homography(on_board, rays);
  if (!found) return std::nullopt;
  Eigen::Matrix3d H = *found;
  H /= std::sqrt(H.col(0).norm() * H.col(1).norm());
  if (H(2, 2) < 0.0) H = -H;
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose3 T_camera_board = Pose3::Identity();
  T_camera_board.linear() = svd.matrixU() * svd.matrixV().transpose();
  T_camera_board.translation() = H.col(2);
  const bool is_valid = T_camera_board.linear().determinant() > 0.0 && T_camera_board.matrix().allFinite();
  return is_valid ? std::optional(T_camera_board) : std::nullopt;
}

}  // namespace vismem
