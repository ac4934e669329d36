/// @file Textures of a renderer as pyramids of smaller copies (mip maps), so that far surfaces do not
/// flicker. Private to Renderer. Pure.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "simulator/core/world.h"

namespace vismem {

/// Immutable after construction: *thread-safe*.
class TexturePyramid {
 public:
  explicit TexturePyramid(const Texture& texture);

  /// Colour at (u, v), repeated beyond 0..1; (0, 0) is the top left corner of the image.
  /// @param texels length of a camera pixel in pixels of the texture.
  Eigen::Vector3f sample(float u, float v, float texels) const;
  /// Size of the full image [px].
  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<std::array<std::uint8_t, 4>> pixels;  ///< R G B and nothing
  };
  static Level halved(const Level& level);
  static Eigen::Vector3f bilinear(const Level& level, float u, float v);

  std::vector<Level> levels_;
};

/// For every triangle of a body: texels per metre, from the ratio of areas. Zero without a texture.
std::vector<float> texelsPerMetre(const WorldBody& body);

}  // namespace vismem
