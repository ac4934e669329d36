/// @file Size and completeness of a JPEG file, without decoding it. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace vismem {

struct JpegHeader {
  int width = 0;       ///< [px]
  int height = 0;      ///< [px]
  int components = 0;  ///< 1: grey, 3: colour
  std::string error;   ///< reason why it is no complete JPEG file; empty if it is complete
};

/// Reads the segments up to the start of the scan and looks for the end mark, which a truncated file lacks;
/// decoders fill truncated images with grey without an error. Zeros after the end mark are allowed, because
/// cameras pad their buffers. Accepts any bytes.
JpegHeader readJpegHeader(std::span<const std::uint8_t> bytes);

}  // namespace vismem
