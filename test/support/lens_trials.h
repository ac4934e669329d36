/// @file Lenses and views drawn by seed, and trials of `calibrate lens` on them: truth for the tests of the
/// lens.
#pragma once

#include <optional>
#include <random>
#include <string>

#include "calibration/core/lens/lens_calibration.h"
#include "calibration/core/lens/lens_session.h"
#include "support/board_renderer.h"

namespace vismem {

/// 640x480; 40 to 100 degrees across, k1 from -0.4 to 0.1, k2 that keeps the image from folding, small p1,
/// p2, an off-centre principal point, pixels that are square within 0.5 %.
CameraIntrinsics drawLens(std::mt19937& random);

/// A board held before the camera: its middle near a place of the image, over a third to the whole width of
/// it, aslant up to 50 degrees. At least 14 corners are in the image.
BoardScene drawScene(const CameraIntrinsics& lens, const BoardSpec& board, const Eigen::Vector2d& near_px,
                     std::mt19937& random);

/// Exact corners with noise, without an image: those in the image by a margin.
BoardView projectedView(const CameraIntrinsics& lens, const BoardScene& scene, double sigma_px,
                        std::mt19937& random);

/// Views as a user makes them who follows the session's advice, until it has enough or a number of images was
/// shown.
/// @param images rendered ones through the detector; false: projectedView.
class BoardHolder {
 public:
  BoardHolder(const CameraIntrinsics& lens, const BoardSpec& board, bool images, unsigned seed);
  /// @return images shown.
  int hold(LensSession& session, int most_images);
  std::mt19937& random() { return random_; }

 private:
  CameraIntrinsics lens_;
  BoardSpec board_;
  std::optional<BoardRenderer> renderer_;
  std::mt19937 random_;
};

/// Errors of one lens against the truth.
struct LensTrial {
  unsigned seed = 0;
  CameraIntrinsics truth;
  double view_deg = 0.0;
  std::string problem;  ///< why there is no lens
  LensCalibration calibration;
  std::vector<BoardView> views;
  int images = 0;               ///< shown
  bool is_enough = false;       ///< by the session's stop rule
  double worst_px = 0.0;        ///< error of the projection, a turn of the camera taken out
  double worst_fixed_px = 0.0;  ///< the same with the camera's axes held
  double squares = 0.0;         ///< mean over a grid: squared error, and the variance that was reported
  double variance = 0.0;
};
LensTrial tryLens(unsigned seed);

/// mrcal's lens from the same corners. @param folder for its files. @return empty when mrcal is not installed
/// or fails.
std::optional<CameraIntrinsics> lensOfMrcal(const LensTrial& trial, const BoardSpec& board,
                                            const std::string& folder, const std::string& model);

}  // namespace vismem
