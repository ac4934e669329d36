/// @file A lens from views of a board, with the evidence for it: model chosen by held-out error,
/// cross-validation, uncertainty, and what speaks against it. Pure. Implements B5.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/core/lens/lens_fit.h"
#include "calibration/core/lens/projection_grid.h"

namespace vismem {

/// Errors of one model over five parts: every fifth view is held out from a fit to the others.
struct ModelScore {
  LensModel model = LensModel::kPinhole;
  double training_rms_px = 0.0;
  double held_out_rms_px = 0.0;
};

struct LensCalibration {
  LensFit fit;
  std::vector<ModelScore> scores;  ///< of all models that could be fitted
  double training_rms_px = 0.0;    ///< of the chosen model
  double held_out_rms_px = 0.0;
  double heldOutRatio() const { return training_rms_px > 0.0 ? held_out_rms_px / training_rms_px : 0.0; }
  /// Between the lenses from the views with even and with odd numbers.
  std::optional<ProjectionDifference> halves;
  ProjectionUncertainty uncertainty;
  double coverage = 0.0;      ///< share of a grid of 8 x 6 cells of the image in which a corner was seen
  double focal_change = 0.0;  ///< spread of the focal length from view to view beyond its noise, as a share
  /// What it means for the user, in words.
  std::vector<std::string> warnings;
};

/// Widest lens that the model can hold [degrees].
inline constexpr double kWidestView_deg = 100.0;
/// Held-out over training error from which on something is wrong.
inline constexpr double kMaxHeldOutRatio = 1.15;

struct LensCalibrationResult {
  std::optional<LensCalibration> calibration;
  std::string refusal;  ///< why there is none
};

/// @param progress called with the finished and all steps; may be empty.
LensCalibrationResult calibrateLens(const BoardSpec& board, const std::vector<BoardView>& views, int width,
                                    int height, const std::function<void(int, int)>& progress = {});

/// How far a floor point moves that a camera sees at an error of its direction [m].
double floorError_m(const CameraIntrinsics& lens, double error_px, double distance_m, double camera_height_m);

}  // namespace vismem
