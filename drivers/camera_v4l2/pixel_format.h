/// @file The supported pixel formats of V4L2, and the conversion of a buffer into an image. Pure.
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

/// Colour before grey, raw before compressed: of equally good formats the first is selected.
std::span<const PixelFormat> pixelFormats();
/// @return nullptr for an unsupported format.
const PixelFormat* formatOf(std::uint32_t fourcc);
/// "YUYV" for 0x56595559, for people.
std::string fourccText(std::uint32_t fourcc);

/// Layout of a running camera's images in its buffers.
struct PictureLayout {
  PixelFormat format;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  int stride = 0;  ///< from row to row [bytes]; 0: without a gap
};

/// A copy of a buffer as an image in a standard format: BGR becomes RGB, motion JPEG a complete JPEG file
/// (motion_jpeg.h). Other formats remain unchanged.
/// @param problem the defect of an incomplete image: "has 100 bytes of 614400".
/// @return nullptr then.
std::shared_ptr<const NativeImage> pictureOf(const PictureLayout& layout, std::span<const std::uint8_t> bytes,
                                             std::string& problem);

}  // namespace vismem::v4l2
