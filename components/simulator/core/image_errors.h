/// @file Errors of a real image sensor: slow changes of exposure, shot noise, read noise. Pure.
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
  /// Standard deviation of the photon noise on white (255) [grey levels]; times sqrt(I / 255) on a level I.
  double shot = 0.0;
  /// Automatic exposure: the log gain is an Ornstein-Uhlenbeck process with this standard deviation and the
  /// correlation time exposure_time_s.
  double exposure_sigma = 0.0;
  double exposure_time_s = 5.0;
};

/// The errors of one camera. The same seed, stamps and images give the same bytes, at any time of rendering.
/// *Single-threaded*.
class ImageErrors {
 public:
  ImageErrors(const ImageErrorParams& params, std::uint64_t seed);

  /// The gain at the next frame's stamp; to be called once per frame, in order, also for frames that are not
  /// rendered.
  double gainAt(StampUs stamp_us);
  /// Applies the gain, then shot noise, then read noise.
  void apply(cv::Mat& image, std::uint64_t seq, double gain) const;

 private:
  void addNoise(cv::Mat& image, std::uint64_t seq) const;

  ImageErrorParams params_;
  std::uint64_t seed_;
  std::mt19937_64 exposure_;
  double log_gain_ = 0.0;
  StampUs gain_us_ = 0;
  bool started_ = false;
  /// Normal numbers in 1/4096; each row of each frame starts at another position.
  std::vector<std::int16_t> normal_;
  std::array<int, 256> sigma_{};  ///< of each grey level, in 1/256
};

}  // namespace vismem
