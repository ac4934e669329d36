/// @file Images of a calibration board through a lens that is known exactly: truth for tests of calibration.
#pragma once

#include <opencv2/core/mat.hpp>
#include <random>

#include "calibration/core/board.h"
#include "common/geometry/camera.h"

namespace vismem {

/// How an image of a board comes about.
struct BoardScene {
  BoardSpec board;  ///< as it really is
  Pose3 T_camera_board = Pose3::Identity();
  double bow_m = 0.0;    ///< the board's middle bulges by this over its ends, across
  double blur_px = 0.7;  ///< standard deviation of the optics' spread
  double noise = 3.0;    ///< standard deviation of a pixel [grey levels of 256]
  double shade = 0.2;    ///< light falls by this share from one side of the image to the other
};

/// Raw pixel of a corner; empty behind the camera. The image's border is not looked at.
std::optional<Eigen::Vector2d> trueCorner(const CameraIntrinsics& lens, const BoardScene& scene, int id);

/// Draws boards by ray tracing: 8 rays a pixel, 64 where they differ.
class BoardRenderer {
 public:
  explicit BoardRenderer(const CameraIntrinsics& lens);

  /// @return CV_8UC1.
  cv::Mat render(const BoardScene& scene, std::mt19937& random) const;

  const CameraIntrinsics& lens() const { return lens_; }

 private:
  Eigen::Vector2d ray(double u, double v) const;

  CameraIntrinsics lens_;
  /// Normalised ideal coordinates of whole pixels, one more on each side.
  cv::Mat rays_;
};

/// Looks at a point of the board from a direction. The camera is upright at `roll_rad` = 0: the board's x
/// goes right and its y up in the image.
/// @param pixel where the point appears in the image (raw).
/// @param slant_rad between the viewing ray and the board's normal; @param turn_rad direction of the slant on
/// the board.
Pose3 boardPose(const CameraIntrinsics& lens, const Eigen::Vector3d& p_board, const Eigen::Vector2d& pixel,
                double distance_m, double slant_rad, double turn_rad, double roll_rad);

}  // namespace vismem
