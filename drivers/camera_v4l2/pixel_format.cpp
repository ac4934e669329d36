#include "drivers/camera_v4l2/pixel_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>

#include "common/image_codec/jpeg_header.h"
#include "drivers/camera_v4l2/motion_jpeg.h"

namespace vismem::v4l2 {
namespace {

constexpr std::array kFormats{
    PixelFormat{V4L2_PIX_FMT_YUYV, "YUYV", NativeFormat::kYuyv, false},
    PixelFormat{V4L2_PIX_FMT_UYVY, "UYVY", NativeFormat::kUyvy, false},
    PixelFormat{V4L2_PIX_FMT_NV12, "NV12", NativeFormat::kNv12, false},
    PixelFormat{V4L2_PIX_FMT_RGB24, "RGB", NativeFormat::kRgb8, false},
    PixelFormat{V4L2_PIX_FMT_BGR24, "BGR", NativeFormat::kRgb8, true},
    PixelFormat{V4L2_PIX_FMT_MJPEG, "MJPEG", NativeFormat::kJpeg, false},
    PixelFormat{V4L2_PIX_FMT_JPEG, "JPEG", NativeFormat::kJpeg, false},
    PixelFormat{V4L2_PIX_FMT_GREY, "GREY", NativeFormat::kGray8, false},
};

int tightRow(const PictureLayout& layout) {
  switch (layout.format.native) {
    case NativeFormat::kYuyv:
    case NativeFormat::kUyvy:
      return 4 * ((layout.width + 1) / 2);
    case NativeFormat::kRgb8:
      return 3 * layout.width;
    case NativeFormat::kGray8:
    case NativeFormat::kNv12:
    case NativeFormat::kJpeg:
      break;
  }
  return layout.width;
}

bool readJpeg(const PictureLayout& layout, std::vector<std::uint8_t>& bytes, std::string& problem) {
  completeJpeg(bytes);
  const JpegHeader header = readJpegHeader(bytes);
  problem = header.error;
  if (problem.empty() && (header.width != layout.width || header.height != layout.height)) {
    problem = "has " + std::to_string(header.width) + "x" + std::to_string(header.height) +
              " pixels, not the " + std::to_string(layout.width) + "x" + std::to_string(layout.height) +
              " of the others";
  }
  return problem.empty();
}

}  // namespace

std::span<const PixelFormat> pixelFormats() {
  return kFormats;
}

const PixelFormat* formatOf(std::uint32_t fourcc) {
  const auto* format = std::find_if(kFormats.begin(), kFormats.end(),
                                    [&](const PixelFormat& f) { return f.fourcc == fourcc; });
  return format == kFormats.end() ? nullptr : format;
}

std::string fourccText(std::uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>((fourcc >> (8 * i)) & 0x7FU);
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::shared_ptr<const NativeImage> pictureOf(const PictureLayout& layout, std::span<const std::uint8_t> bytes,
                                             std::string& problem) {
  auto picture = std::make_shared<NativeImage>();
  picture->format = layout.format.native;
  picture->width = layout.width;
  picture->height = layout.height;
  if (layout.format.native == NativeFormat::kJpeg) {
    picture->bytes.assign(bytes.begin(), bytes.end());
    return readJpeg(layout, picture->bytes, problem) ? picture : nullptr;
  }
  const int row = tightRow(layout);
  picture->stride = std::max(layout.stride, row);
  const int rows = layout.format.native == NativeFormat::kNv12 ? layout.height * 3 / 2 : layout.height;
  // The last row needs no padding after it.
  const std::size_t needed = static_cast<std::size_t>(picture->stride) * static_cast<std::size_t>(rows - 1) +
                             static_cast<std::size_t>(row);
  if (bytes.size() < needed) {
    problem = "has " + std::to_string(bytes.size()) + " bytes of " + std::to_string(needed);
    return nullptr;
  }
  picture->bytes.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(needed));
  if (layout.format.swaps_red_and_blue) {
    for (int y = 0; y < layout.height; ++y) {
      std::uint8_t* pixel = picture->bytes.data() + static_cast<std::ptrdiff_t>(y) * picture->stride;
      for (int x = 0; x < layout.width; ++x, pixel += 3) std::swap(pixel[0], pixel[2]);
    }
  }
  return picture;
}

}  // namespace vismem::v4l2
