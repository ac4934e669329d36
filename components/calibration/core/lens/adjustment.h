/// @file The least-squares problem behind fitLens: unknowns, residuals, covariance. *Single-threaded.*
#pragma once

#include <array>
#include <vector>

#include "calibration/core/lens/lens_model.h"

namespace vismem {

struct LensUnknowns {
  LensVector lens = LensVector::Zero();
  Eigen::Vector2d bow_m = Eigen::Vector2d::Zero();
  std::vector<std::array<double, 6>>
      poses;  ///< angle-axis and translation of the board in the camera's frame
};

std::array<double, 6> poseVector(const Pose3& pose);
Pose3 poseFrom(const std::array<double, 6>& vector);

/// Which unknowns a solution may change, and its kernel.
struct AdjustmentOptions {
  int free_lens = kLensParameters;  ///< the first so many of LensVector; 0: the lens is known
  bool is_bow_free = true;
  double cauchy = 0.0;  ///< scale of a Cauchy kernel, in sigmas; 0: least squares
};

class Adjustment {
 public:
  /// @param views must outlive it. Weak priors keep unknowns finite that few views do not determine: a
  /// principal point within about a tenth of the image from its middle, distortion below about 1, a bow of
  /// about 2 mm.
  Adjustment(const BoardSpec& board, const std::vector<BoardView>& views, int width, int height);

  /// @return mean cost of a used corner, after the kernel; infinite when the solution failed.
  double solve(LensUnknowns& unknowns, const std::vector<std::vector<bool>>& is_used,
               const AdjustmentOptions& options) const;

  /// Projected - measured [px].
  std::vector<std::vector<Eigen::Vector2d>> residuals(const LensUnknowns& unknowns) const;

  /// Standard deviation that a corner has in the fit: its own and a floor for the print's errors [px].
  double sigmaOf(const BoardCorner& corner) const;

  struct Covariance {
    LensMatrix P_lens = LensMatrix::Zero();
    Eigen::Vector2d bow_sigma_m = Eigen::Vector2d::Zero();
  };
  /// Of the lens and the bow over all poses (Schur complement), with the residuals' own noise.
  Covariance covariance(const LensUnknowns& unknowns, const std::vector<std::vector<bool>>& is_used,
                        const AdjustmentOptions& options) const;

  /// How the focal length of each view by itself differs from that of all: share and its sigma. A view
  /// without a meaningful answer has an infinite sigma.
  struct FocalChange {
    double share = 0.0;
    double sigma = 0.0;
  };
  std::vector<FocalChange> focalChanges(const LensUnknowns& unknowns,
                                        const std::vector<std::vector<bool>>& is_used) const;

 private:
  /// Residuals over sigma and their derivatives, summed over a view's used corners. Order of unknowns: lens,
  /// bow.
  struct ViewEquations {
    static constexpr int kCommon = kLensParameters + 2;
    Eigen::Matrix<double, kCommon, kCommon> H = Eigen::Matrix<double, kCommon, kCommon>::Zero();
    Eigen::Matrix<double, kCommon, 6> H_pose = Eigen::Matrix<double, kCommon, 6>::Zero();
    Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, kCommon, 1> g = Eigen::Matrix<double, kCommon, 1>::Zero();
    Eigen::Matrix<double, 6, 1> g_pose = Eigen::Matrix<double, 6, 1>::Zero();
    double squares = 0.0;
    int corners = 0;
  };
  ViewEquations equations(const LensUnknowns& unknowns, std::size_t view,
                          const std::vector<bool>& is_used) const;
  CornerError errorOf(const BoardCorner& corner) const;

  const BoardSpec board_;
  const std::vector<BoardView>& views_;
  LensVector prior_mean_ = LensVector::Zero();
  LensVector prior_weight_ = LensVector::Zero();  ///< 1 / sigma
};

}  // namespace vismem
