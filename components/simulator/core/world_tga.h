/// @file Pictures in the TGA format, which OpenCV does not read. Pure.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string_view>

namespace vismem {

/// A TGA picture: true colour (15 to 32 bits), grey or with a colour map, plain or run-length encoded, from
/// any corner. Its alpha is left out. The format has no magic number: try all others first.
/// @return CV_8UC3 in the order B, G, R; empty for bytes that are none, or cut off, or more than 2^27 px.
cv::Mat decodeTga(std::string_view bytes);

}  // namespace vismem
