/// @file The dominant direction of a place: that of its long straight lines, modulo 90 degrees. Pure. See M6.
/// After J. Coughlan, A. Yuille, "Manhattan world: compass direction from a single image", ICCV 1999; the
/// histogram is over remembered lines instead of image gradients.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace vismem {

struct DominantDirectionParams {
  double least_m = 0.5;       ///< length of a line; shorter ones may be chords of a curve
  double together_rad = 0.1;  ///< lines within this of a direction support it
  int least_lines = 4;        ///< remembered lines that must support a direction
  double least_share = 0.75;  ///< of the length of all lines that must support it
};

/// Histogram of directions modulo 90 degrees, weighted by length. *Single-threaded value.*
class DominantDirection {
 public:
  explicit DominantDirection(const DominantDirectionParams& params) : params_(params) {
    sums_.fill(Eigen::Vector2d::Zero());
  }
  /// Adds a line; lines shorter than least_m are ignored.
  void add(double direction_rad, double length_m);
  /// @return in -45..45 degrees from the axes of the frame [rad]; empty if no direction has enough support.
  std::optional<double> direction() const;

 private:
  static constexpr int kBins = 30;  ///< of 3 degrees
  DominantDirectionParams params_;
  std::array<double, kBins> length_m_{};
  std::array<Eigen::Vector2d, kBins> sums_;  ///< unit vectors of four times the direction, weighted by length
  std::array<int, kBins> lines_{};
  double all_m_ = 0.0;
};

/// Signed angle from a dominant direction to a direction, modulo 90 degrees, in -45..45 degrees [rad].
double offDominantDirection(double direction_rad, double dominant_direction_rad);

}  // namespace vismem
