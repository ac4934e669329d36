/// @file What a real sensor does to an image: slow changes of exposure, shot noise, read noise. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <random>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

struct ImageErrorParams {
  double gaussian = 2.0;  ///< standard deviation of the read noise [grey levels]
  /// Standard deviation of the photons' noise on white (255) [grey levels]; on a level I it is sqrt(I / 255)
  /// of it.
  double shot = 0.0;
  /// The gain wanders like that of an automatic exposure: the standard deviation of its logarithm, and the
  /// time after which it has forgotten where it was (an Ornstein-Uhlenbeck process).
  double exposure_sigma = 0.0;
  double exposure_time_s = 5.0;
};

/// The errors of one camera. The same seed, stamps and images give the same bytes, whenever the image is
/// made. *Single-threaded*.
class ImageErrors {
 public:
  ImageErrors(const ImageErrorParams& params, std::uint64_t seed);

  /// The gain at the next frame's stamp; to be asked once a frame, in order, whether or not it will be
  /// rendered.
  double gainAt(StampUs stamp_us);
  /// Gain first, then noise of the light that arrives, then of reading it.
  void apply(cv::Mat& image, std::uint64_t seq, double gain) const;

 private:
  void addNoise(cv::Mat& image, std::uint64_t seq) const;

  ImageErrorParams params_;
  std::uint64_t seed_;
  std::mt19937_64 exposure_;
  double log_gain_ = 0.0;
  StampUs gain_us_ = 0;
  bool started_ = false;
  /// Normal numbers in 1/4096, read from another place for every row of every frame.
  std::vector<std::int16_t> normal_;
  std::array<int, 256> sigma_{};  ///< of each grey level, in 1/256
};

}  // namespace vismem
