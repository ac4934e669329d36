#include "calibration/core/lens/lens_calibration.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <set>
#include <sstream>

#include "calibration/core/lens/adjustment.h"

namespace vismem {
namespace {

constexpr int kParts = 5;
/// Spread of the focal length that autofocus causes at least, and its evidence (mean of squares over sigmas).
constexpr double kMaxFocalChange = 0.002;
constexpr double kFocalEvidence = 4.0;
constexpr double kMaxBow_m = 0.001;
constexpr double kMaxAspect = 0.01;

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// Views whose number leaves `rest`, or all others.
std::vector<BoardView> part(const std::vector<BoardView>& views, std::size_t divisor, std::size_t rest,
                            bool is_inside) {
  std::vector<BoardView> chosen;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if ((i % divisor == rest) == is_inside) chosen.push_back(views[i]);
  }
  return chosen;
}

/// Sums of squares of used corners.
struct Squares {
  double sum = 0.0;
  int corners = 0;

  void add(const std::vector<FittedView>& views) {
    for (const FittedView& view : views) {
      for (std::size_t i = 0; i < view.residuals_px.size(); ++i) {
        if (!view.is_used[i]) continue;
        sum += view.residuals_px[i].squaredNorm();
        ++corners;
      }
    }
  }
  double rms() const { return corners > 0 ? std::sqrt(sum / corners) : 0.0; }
};

/// By how much the focal lengths differ, as a share.
double aspectError(const CameraIntrinsics& lens) {
  return lens.fx / lens.fy - 1.0;
}

class LensCalibrator {
 public:
  LensCalibrator(const BoardSpec& board, const std::vector<BoardView>& views, int width, int height,
                 const std::function<void(int, int)>& progress)
      : board_(board), views_(views), width_(width), height_(height), progress_(progress) {}

  LensCalibrationResult run() {
    std::vector<LensFit> fits;
    LensCalibration result;
    std::string problem;
    for (const LensModel model : kLensModels) {
      auto fitted = fitLens(board_, views_, width_, height_, {model, false, startFrom(fits)});
      step(1);
      if (!fitted.fit) {
        problem = fitted.problem;
        step(kParts);
        continue;
      }
      result.scores.push_back(score(model, fitted.fit->lens));
      fits.push_back(std::move(*fitted.fit));
    }
    if (fits.empty()) return {std::nullopt, problem};
    const std::size_t chosen = choose(result.scores);
    result.fit = fits[chosen];
    result.training_rms_px = result.scores[chosen].training_rms_px;
    result.held_out_rms_px = result.scores[chosen].held_out_rms_px;
    describe(result);
    if (std::string refusal = refusalOf(result); !refusal.empty()) return {std::nullopt, std::move(refusal)};
    warn(result);
    return {std::move(result), {}};
  }

 private:
  static std::optional<CameraIntrinsics> startFrom(const std::vector<LensFit>& fits) {
    return fits.empty() ? std::nullopt : std::optional(fits.back().lens);
  }

  void step(int steps) {
    done_ += steps;
    constexpr int kAll = static_cast<int>(kLensModels.size()) * (1 + kParts);
    if (progress_) progress_(done_, kAll);
  }

  ModelScore score(LensModel model, const CameraIntrinsics& start) {
    ModelScore result{model};
    Squares training;
    Squares held_out;
    bool is_whole = true;
    for (std::size_t rest = 0; rest < kParts; ++rest, step(1)) {
      const auto outside = part(views_, kParts, rest, true);
      const auto fitted =
          fitLens(board_, part(views_, kParts, rest, false), width_, height_, {model, false, start});
      if (outside.empty()) continue;
      const auto seen =
          fitted.fit ? fitPoses(fitted.fit->lens, fitted.fit->bow_m, board_, outside) : std::nullopt;
      if (!seen) {
        is_whole = false;
        continue;
      }
      training.add(fitted.fit->views);
      held_out.add(*seen);
    }
    result.training_rms_px = training.rms();
    result.held_out_rms_px = is_whole ? held_out.rms() : 0.0;
    return result;
  }

  /// The model of the least held-out error.
  static std::size_t choose(const std::vector<ModelScore>& scores) {
    // 0: some part could not be fitted.
    const auto error = [](const ModelScore& score) {
      return score.held_out_rms_px > 0.0 ? score.held_out_rms_px : INFINITY;
    };
    return static_cast<std::size_t>(std::ranges::min_element(scores, {}, error) - scores.begin());
  }

  void describe(LensCalibration& result) const {
    result.uncertainty =
        projectionUncertainty(result.fit.lens, result.fit.P_lens, pixelGrid(width_, height_));
    const LensFitOptions options{result.fit.model, false, result.fit.lens};
    const auto even = fitLens(board_, part(views_, 2, 0, true), width_, height_, options);
    const auto odd = fitLens(board_, part(views_, 2, 1, true), width_, height_, options);
    if (even.fit && odd.fit)
      result.halves = projectionDifference(even.fit->lens, odd.fit->lens, pixelGrid(width_, height_));
    result.coverage = coverage();
    result.focal_change = focalChange(result.fit);
  }

  double coverage() const {
    constexpr int kColumns = 8;
    constexpr int kRows = 6;
    std::set<int> cells;
    for (const BoardView& view : views_) {
      for (const BoardCorner& corner : view.corners) {
        const int column = static_cast<int>((corner.pixel.x() + 0.5) / width_ * kColumns);
        const int row = static_cast<int>((corner.pixel.y() + 0.5) / height_ * kRows);
        cells.insert(row * kColumns + column);
      }
    }
    return static_cast<double>(cells.size()) / (kColumns * kRows);
  }

  /// @return 0 unless the views contradict one focal length.
  double focalChange(const LensFit& fit) const {
    const Adjustment adjustment(board_, views_, width_, height_);
    LensUnknowns unknowns{lensVector(fit.lens), fit.bow_m, {}};
    std::vector<std::vector<bool>> used;
    for (const FittedView& view : fit.views) {
      unknowns.poses.push_back(poseVector(view.T_camera_board));
      used.push_back(view.is_used);
    }
    double evidence = 0.0;
    double excess = 0.0;
    double weights = 0.0;
    int count = 0;
    for (const auto& change : adjustment.focalChanges(unknowns, used)) {
      if (!std::isfinite(change.sigma)) continue;
      const double variance = change.sigma * change.sigma;
      evidence += change.share * change.share / variance;
      excess += (change.share * change.share - variance) / variance;
      weights += 1.0 / variance;
      ++count;
    }
    if (count == 0 || evidence / count < kFocalEvidence) return 0.0;
    return std::sqrt(std::max(0.0, excess / weights));
  }

  std::string refusalOf(const LensCalibration& result) const {
    const double view_deg = horizontalView_rad(result.fit.lens) * 180.0 / std::numbers::pi;
    if (view_deg > kWidestView_deg) {
      return "the lens sees " + rounded(view_deg, 0) + " degrees across: above " +
             rounded(kWidestView_deg, 0) +
             " degrees the lens model (plumb_bob) does not hold; a fisheye lens cannot be calibrated yet";
    }
    // A print that is longer one way looks like a focal length that changes with the board's roll.
    if (result.focal_change > kMaxFocalChange && std::abs(aspectError(result.fit.lens)) <= kMaxAspect) {
      return "the focal length changes by " + rounded(100.0 * result.focal_change, 1) +
             " % from view to view: switch off autofocus, zoom and image stabilisation, and begin with an "
             "empty folder";
    }
    return {};
  }

  static void warn(LensCalibration& result) {
    const LensFit& fit = result.fit;
    if (result.heldOutRatio() > kMaxHeldOutRatio) {
      result.warnings.push_back("views that were held out fit " +
                                rounded(100.0 * (result.heldOutRatio() - 1.0), 0) +
                                " % worse than the others: more views are needed, or the board is not flat");
    }
    const double bow_m = fit.bow_m.cwiseAbs().maxCoeff();
    if (bow_m > kMaxBow_m && (fit.bow_m.cwiseAbs().array() > 3.0 * fit.bow_sigma_m.array()).any()) {
      result.warnings.push_back(
          "the board is bent by " + rounded(1e3 * bow_m, 1) +
          " mm: the lens allows for it, but calibrate body does not; glue it onto something flat");
    }
    if (std::abs(aspectError(fit.lens)) > kMaxAspect) {
      result.warnings.push_back("focal lengths across and down differ by " +
                                rounded(100.0 * std::abs(aspectError(fit.lens)), 1) +
                                " %: were the printed rulers measured both ways?");
    }
    constexpr double kManyOutliers = 0.05;
    if (fit.outliers > kManyOutliers * (fit.corners + fit.outliers)) {
      result.warnings.push_back(std::to_string(fit.outliers) + " of " +
                                std::to_string(fit.corners + fit.outliers) +
                                " corners do not fit and were left out");
    }
  }

  const BoardSpec& board_;
  const std::vector<BoardView>& views_;
  const int width_;
  const int height_;
  const std::function<void(int, int)>& progress_;
  int done_ = 0;
};

}  // namespace

LensCalibrationResult calibrateLens(const BoardSpec& board, const std::vector<BoardView>& views, int width,
                                    int height, const std::function<void(int, int)>& progress) {
  return LensCalibrator(board, views, width, height, progress).run();
}

double floorError_m(const CameraIntrinsics& lens, double error_px, double distance_m,
                    double camera_height_m) {
  // Distance d = h / tan(angle below the horizon); its derivative by that angle is (d^2 + h^2) / h.
  const double error_rad = error_px / std::min(lens.fx, lens.fy);
  return error_rad * (distance_m * distance_m + camera_height_m * camera_height_m) / camera_height_m;
}

}  // namespace vismem
