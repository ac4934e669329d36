/// @file What a JPEG file says of itself, without decoding it. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace vismem {

struct JpegHeader {
  int width = 0;       ///< [px]
  int height = 0;      ///< [px]
  int components = 0;  ///< 1: grey, 3: colour
  std::string error;   ///< why it is no whole JPEG file; empty if it is
};

/// Walks the segments up to the start of the scan and looks for the end mark, which a file that was cut short
/// lacks (decoders fill the rest with grey and call it a success). Zeros after the end mark are allowed:
/// cameras pad their buffers. Works on any bytes.
JpegHeader readJpegHeader(std::span<const std::uint8_t> bytes);

}  // namespace vismem
