/// @file What errors of a lens mean in the image: its uncertainty, and the difference of two lenses, on a
/// grid of pixels. Pure. Both are of directions, so they hold at any distance. A turn of the camera as a
/// whole is taken out: the calibration of the mounting absorbs it. After mrcal (Kogan), "projection
/// uncertainty" and "projection difference".
#pragma once

#include <vector>

#include "calibration/core/lens/lens_model.h"

namespace vismem {

/// Pixels from corner to corner of the image, row by row.
struct PixelGrid {
  int columns = 9;
  int rows = 7;
  std::vector<Eigen::Vector2d> px;
};
PixelGrid pixelGrid(int width, int height, int columns = 9, int rows = 7);

struct ProjectionUncertainty {
  PixelGrid grid;
  std::vector<Eigen::Matrix2d> P_px;  ///< covariance of the projection at each pixel [px^2]
  std::vector<double> sigma_px;       ///< in the worst direction
  std::size_t worst = 0;              ///< index of the largest sigma
};
/// @param P covariance of lensVector(lens).
ProjectionUncertainty projectionUncertainty(const CameraIntrinsics& lens, const LensMatrix& P,
                                            const PixelGrid& grid);

struct ProjectionDifference {
  PixelGrid grid;                              ///< pixels of the first lens
  std::vector<Eigen::Vector2d> difference_px;  ///< second - first, for the same direction
  double worst_px = 0.0;
  double p90_px = 0.0;  ///< 90 % of the pixels differ by less
};
/// @param is_turn_free false: the cameras' axes are the same, and a turn counts as a difference.
ProjectionDifference projectionDifference(const CameraIntrinsics& first, const CameraIntrinsics& second,
                                          const PixelGrid& grid, bool is_turn_free = true);

/// Angle between the viewing rays of the leftmost and the rightmost pixel of the middle row, through the
/// distortion [rad].
double horizontalView_rad(const CameraIntrinsics& lens);

}  // namespace vismem
