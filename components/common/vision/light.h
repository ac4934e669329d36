/// @file The light of an image relative to the light a palette was made for. Pure. See V3.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

namespace vismem {

/// What turns a pixel's values v (0..1) into those under the palette's light:
/// `gain * v^gamma / (1 - vignette r^2)`, channel by channel; r is 0 in the middle of the image and 1 in its
/// corners.
struct ImageLight {
  Eigen::Vector3d gain{1.0, 1.0, 1.0};  ///< of red, green, blue; > 0
  double gamma = 1.0;                   ///< > 0
  double vignette = 0.0;                ///< share of the brightness that the corners lose, 0..0.8

  bool isNeutral() const { return gain == Eigen::Vector3d::Ones() && gamma == 1.0 && vignette == 0.0; }
};

/// The light in words, to one decimal: "images are 0.5 times as bright as the palette expects, red 1.2
/// times". Empty for a light that differs by less than a tenth.
std::string describe(const ImageLight& light);

/// The corrected values of all pixel values. *Immutable*.
class LightTable {
 public:
  explicit LightTable(const ImageLight& light);

  /// Index of the places at this share of the squared distance from the middle to a corner (0..1).
  static int ring(double r2) { return static_cast<int>(r2 * (kRings - 1) + 0.5); }
  /// Corrected value of a channel (0 red, 1 green, 2 blue).
  std::uint8_t at(int ring, int channel, std::uint8_t value) const {
    return levels_[(static_cast<std::size_t>(ring) * 3 + channel) * 256 + value];
  }
  /// @param image CV_8UC3 (R, G, B), or another type, which is returned as it is.
  /// @param corrected replaced; its memory is used again when the size is the same.
  void correct(const cv::Mat& image, cv::Mat& corrected) const;

 private:
  static constexpr int kRings = 32;
  std::array<std::uint8_t, static_cast<std::size_t>(kRings) * 3 * 256> levels_;
  bool has_rings_ = false;
};

}  // namespace vismem
