/// @file Conversion of motion JPEG into standard JPEG files. Pure.
#pragma once

#include <cstdint>
#include <vector>

namespace vismem::v4l2 {

/// Removes bytes behind the image in a camera's buffer. Inserts the standard Huffman tables (ITU T.81 annex
/// K) that motion JPEG may omit. Complete files, and bytes that are no JPEG, remain unchanged.
void completeJpeg(std::vector<std::uint8_t>& bytes);

}  // namespace vismem::v4l2
