// Tests C1.
#include "simulator/core/renderer_texture.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

/// Brightness grows to the right by 2 a column.
Texture ramp(int width, int height) {
  Texture texture;
  texture.width = width;
  texture.height = height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) texture.rgb.insert(texture.rgb.end(), 3, static_cast<std::uint8_t>(2 * x));
  }
  return texture;
}

TEST(TexturePyramid, PicturesOfEverySizeStayWhereTheyAre) {
  for (const int width : {64, 63, 77, 101, 127}) {
    const TexturePyramid pyramid(ramp(width, 31));
    for (const float texels : {1.0f, 2.0f, 4.0f, 8.0f}) {
      const float rim = texels / static_cast<float>(width);
      for (float u = rim; u < 1.0f - rim; u += 0.01f) {
        const float expected = 2.0f * (u * static_cast<float>(width) - 0.5f) / 255.0f;
        EXPECT_NEAR(pyramid.sample(u, 0.5f, texels).x(), expected, 1.0f / 255.0f)
            << "width " << width << ", " << texels << " texels a pixel, at " << u;
      }
    }
  }
}

}  // namespace
}  // namespace vismem
