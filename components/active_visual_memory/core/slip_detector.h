/// @file Does the heading of odometry slip? Pure. SPEC M6.
#pragma once

#include <deque>
#include <optional>

#include "common/robot/samples.h"

namespace vismem {

/// Feet slip: the heading then is another one from one image to the next. With a body that sways a single
/// image tells its heading against the course of the place by some degrees only, so what several images tell
/// is put together before it is believed. *Single-threaded value.*
class SlipDetector {
 public:
  struct Params {
    int images = 10;          ///< at most so many are put together, ..
    int least_images = 3;     ///< .. and at least so many
    double sigmas = 4.0;      ///< a deviation is a slip beyond so many of its standard deviations ..
    double least_rad = 0.03;  ///< .. and beyond this
  };
  struct Slip {
    double turn_rad = 0.0;
    double sigma_rad = 0.0;
    StampUs since_us = 0;  ///< the first image that told of it
  };

  /// @param deviation_rad of the image's lines from where the memory's course puts them; it sways from image
  /// to image with this variance.
  /// @return a slip, once; then all begins anew.
  std::optional<Slip> add(StampUs stamp_us, double deviation_rad, double variance_rad2, const Params& params);
  void reset() { told_.clear(); }

 private:
  struct Told {
    StampUs stamp_us;
    double deviation_rad;
    double information;
  };
  std::deque<Told> told_;
};

}  // namespace vismem
