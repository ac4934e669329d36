/// @file Fit of a lens and of the board's poses to views of the board: bundle adjustment (Zhang 2000) in
/// Ceres. Pure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/core/lens/lens_model.h"

namespace vismem {

/// One view in a fit. Lists follow BoardView::corners.
struct FittedView {
  Pose3 T_camera_board = Pose3::Identity();
  std::vector<Eigen::Vector2d> residuals_px;  ///< projected - measured
  std::vector<bool> is_used;                  ///< false: outlier
  double rms_px = 0.0;                        ///< root mean square of the distances of used corners
};

struct LensFit {
  CameraIntrinsics lens;
  LensModel model = LensModel::kPinhole;
  Eigen::Vector2d bow_m = Eigen::Vector2d::Zero();  ///< see boardHeight
  Eigen::Vector2d bow_sigma_m = Eigen::Vector2d::Zero();
  std::vector<FittedView> views;  ///< as the views that were given
  /// Covariance of lensVector(lens): measurement noise as the residuals show it; 0 for what is not free.
  LensMatrix P_lens = LensMatrix::Zero();
  double rms_px = 0.0;  ///< root mean square of the distances of used corners
  int corners = 0;      ///< used
  int outliers = 0;
};

struct LensFitOptions {
  LensModel model = LensModel::kFull;
  bool is_board_flat = false;             ///< true: no bow is estimated
  std::optional<CameraIntrinsics> start;  ///< otherwise several fields of view are tried
};

/// A fit, or why there is none.
struct LensFitResult {
  std::optional<LensFit> fit;
  std::string problem;
};

inline constexpr int kMinLensViews = 3;
inline constexpr int kMinViewCorners = 6;

/// @param views each with kMinViewCorners corners or more, in images of one size.
LensFitResult fitLens(const BoardSpec& board, const std::vector<BoardView>& views, int width, int height,
                      const LensFitOptions& options);

/// Poses of the board for a known lens, each view by itself: the error on views that did not fit the lens.
/// @return empty when a view has no pose.
std::optional<std::vector<FittedView>> fitPoses(const CameraIntrinsics& lens, const Eigen::Vector2d& bow_m,
                                                const BoardSpec& board, const std::vector<BoardView>& views);

/// Root mean square of the distances of all used corners of several views [px].
double rmsOf(const std::vector<FittedView>& views);

}  // namespace vismem
