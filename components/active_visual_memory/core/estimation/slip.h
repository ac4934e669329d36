/// @file Slips of the odometry's heading. Pure. See M6.
#pragma once

#include <optional>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

/// Test for a jump of the heading: the mean deviation of the latest images from the dominant direction,
/// against its standard deviation. The tilt of a walking body makes one image uncertain by some degrees, so
/// several must agree. *Single-threaded value.*
class SlipDetector {
 public:
  struct Params {
    int images = 10;          ///< the mean is over at most this many images
    int least_images = 3;     ///< and at least this many
    double sigmas = 4.0;      ///< of the mean beyond which it is a slip
    double least_rad = 0.03;  ///< and the mean must exceed this
  };
  struct Slip {
    double turn_rad = 0.0;
    double sigma_rad = 0.0;
    StampUs since_us = 0;  ///< the first image after the slip
  };

  /// @param deviation_rad  of the lines of one image from the dominant direction.
  /// @param variance_rad2  of this deviation, of the per-frame tilt included; independent between images.
  /// @return a slip once; then the images begin anew.
  std::optional<Slip> add(StampUs stamp_us, double deviation_rad, double variance_rad2, const Params& params);
  void reset() { deviations_.clear(); }

 private:
  struct Deviation {
    StampUs stamp_us;
    double deviation_rad;
    double information;
  };
  std::vector<Deviation> deviations_;
};

}  // namespace vismem
