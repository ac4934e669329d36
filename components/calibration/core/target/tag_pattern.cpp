#include "calibration/core/target/tag_pattern.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <cassert>

namespace vismem {

TagPattern tagPattern(TagFamily, int id) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* image = apriltag_to_image(family, static_cast<std::uint32_t>(id));
  // The image has the white ring, one module wide.
  const int ring = (family->total_width - family->width_at_border) / 2;
  assert(family->width_at_border == TagPattern::kModules);
  TagPattern pattern;
  for (int row = 0; row < TagPattern::kModules; ++row) {
    for (int column = 0; column < TagPattern::kModules; ++column) {
      pattern.black[row][column] = image->buf[(row + ring) * image->stride + column + ring] == 0;
    }
  }
  image_u8_destroy(image);
  tag36h11_destroy(family);
  return pattern;
}

}  // namespace vismem
