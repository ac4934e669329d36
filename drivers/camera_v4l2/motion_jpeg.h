/// @file What cameras call JPEG, made into files that every reader of JPEG takes. Pure.
#pragma once

#include <cstdint>
#include <vector>

namespace vismem::v4l2 {

/// Cuts off what a camera left in its buffer behind the picture, and puts in the Huffman tables of the
/// standard (ITU T.81 annex K) where the camera left them out, as those of motion JPEG may. A picture that is
/// a whole file stays byte for byte as it is; so does what is none.
void completeJpeg(std::vector<std::uint8_t>& bytes);

}  // namespace vismem::v4l2
