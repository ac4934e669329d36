#include "support/emulated_picture.h"

#include <algorithm>
#include <opencv2/core.hpp>

#include "common/image_codec/image_codec.h"

namespace vismem {
namespace {

std::vector<std::uint8_t> withoutTables(const std::vector<std::uint8_t>& jpeg) {
  std::vector<std::uint8_t> bytes(jpeg.begin(), jpeg.begin() + 2);
  std::size_t at = 2;
  while (jpeg[at + 1] != 0xDA) {
    const std::size_t end = at + 2 + (static_cast<std::size_t>(jpeg[at + 2]) << 8U | jpeg[at + 3]);
    if (jpeg[at + 1] != 0xC4) {
      bytes.insert(bytes.end(), jpeg.begin() + static_cast<std::ptrdiff_t>(at),
                   jpeg.begin() + static_cast<std::ptrdiff_t>(end));
    }
    at = end;
  }
  bytes.insert(bytes.end(), jpeg.begin() + static_cast<std::ptrdiff_t>(at), jpeg.end());
  bytes.insert(bytes.end(), {0x12, 0x34, 0x56});
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> paintPicture(const std::string& fourcc, int width, int height, std::uint8_t shade,
                                       bool bare) {
  if (fourcc == "MJPG") {
    const auto jpeg = encodeJpeg(cv::Mat(height, width, CV_8UC3, cv::Scalar::all(shade)), 90);
    return bare ? withoutTables(jpeg) : jpeg;
  }
  const auto pixels = static_cast<std::size_t>(width * height);
  std::vector<std::uint8_t> bytes;
  if (fourcc == "YUYV" || fourcc == "UYVY") {
    bytes.assign(2 * pixels, 128);
    for (std::size_t i = fourcc == "YUYV" ? 0 : 1; i < bytes.size(); i += 2) bytes[i] = shade;
  } else if (fourcc == "NV12") {
    bytes.assign(pixels * 3 / 2, 128);
    std::fill_n(bytes.begin(), pixels, shade);
  } else {
    bytes.assign(fourcc == "GREY" ? pixels : 3 * pixels, shade);
  }
  return bytes;
}

}  // namespace vismem
