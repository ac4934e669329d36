/// @file The pixel formats of V4L2 that we read, and a buffer of one as a picture. Pure.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/robot/samples.h"

namespace vismem::v4l2 {

struct PixelFormat {
  std::uint32_t fourcc = 0;
  const char* name = "";  ///< as in configurations: "MJPEG"
  NativeFormat native = NativeFormat::kYuyv;
  bool swaps_red_and_blue = false;
};

/// Colour before grey, raw before compressed: of formats that do equally well the first is taken.
std::span<const PixelFormat> pixelFormats();
/// @return nullptr for one that we do not read.
const PixelFormat* formatOf(std::uint32_t fourcc);
/// "YUYV" for 0x56595559, for people.
std::string fourccText(std::uint32_t fourcc);

/// How the pictures of a running camera lie in its buffers.
struct PictureLayout {
  PixelFormat format;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  int stride = 0;  ///< from row to row [bytes]; 0: without a gap
};

/// A copy of a buffer's bytes as a picture that anyone can read: BGR becomes RGB, a motion JPEG a whole JPEG
/// file (motion_jpeg.h); all else is byte for byte as captured.
/// @param problem what is wrong with a picture that is not whole: "has 100 bytes of 614400".
/// @return nullptr then.
std::shared_ptr<const NativeImage> pictureOf(const PictureLayout& layout, std::span<const std::uint8_t> bytes,
                                             std::string& problem);

}  // namespace vismem::v4l2
