#include "common/image_codec/image_codec.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/image_codec/jpeg_header.h"
#include "common/robot/ports.h"

namespace vismem {
namespace {

constexpr int kReadFlags = cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION;

DecodedImage failed(std::string why) {
  return {{}, std::move(why)};
}

DecodedImage decodeBytes(std::span<const std::uint8_t> bytes) {
  cv::Mat image;
  try {
    image = cv::imdecode(
        cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data())),
        kReadFlags);
  } catch (const cv::Exception& error) {
    return failed("cannot be decoded: " + error.err);
  }
  if (image.empty()) return failed("cannot be decoded");
  if (image.channels() == 1) return {image, {}};
  cv::Mat rgb;
  cv::cvtColor(image, rgb, image.channels() == 4 ? cv::COLOR_BGRA2RGB : cv::COLOR_BGR2RGB);
  return {rgb, {}};
}

bool isJpeg(std::span<const std::uint8_t> bytes) {
  return bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8;
}

/// Checks a JPEG before it is decoded: a header may announce gigabytes.
/// @return the problem; empty without one.
std::string jpegProblem(std::span<const std::uint8_t> bytes) {
  const JpegHeader header = readJpegHeader(bytes);
  if (!header.error.empty()) return header.error;
  if (std::max(header.width, header.height) <= kMaxImageSide_px) return {};
  return "has " + std::to_string(header.width) + "x" + std::to_string(header.height) + " pixels (at most " +
         std::to_string(kMaxImageSide_px) + " on a side)";
}

int bytesPerRow(const PictureView& native) {
  switch (native.format) {
    case NativeFormat::kRgb8:
      return 3 * native.width;
    case NativeFormat::kYuyv:
    case NativeFormat::kUyvy:
      return 4 * ((native.width + 1) / 2);
    case NativeFormat::kGray8:
    case NativeFormat::kNv12:
    case NativeFormat::kJpeg:
      break;
  }
  return native.width;
}

/// A view of the rows, which must not outlive the picture.
cv::Mat rowsOf(const PictureView& native, int rows, int columns, int type, std::size_t stride) {
  return cv::Mat(rows, columns, type, const_cast<std::uint8_t*>(native.bytes.data()), stride);
}

DecodedImage decodeRaw(const PictureView& native, std::size_t stride) {
  cv::Mat image;
  const int pairs = (native.width + 1) / 2;
  switch (native.format) {
    case NativeFormat::kRgb8:
      image = rowsOf(native, native.height, native.width, CV_8UC3, stride).clone();
      break;
    case NativeFormat::kGray8:
      image = rowsOf(native, native.height, native.width, CV_8UC1, stride).clone();
      break;
    case NativeFormat::kYuyv:
      cv::cvtColor(rowsOf(native, native.height, 2 * pairs, CV_8UC2, stride), image, cv::COLOR_YUV2RGB_YUY2);
      break;
    case NativeFormat::kUyvy:
      cv::cvtColor(rowsOf(native, native.height, 2 * pairs, CV_8UC2, stride), image, cv::COLOR_YUV2RGB_UYVY);
      break;
    case NativeFormat::kNv12:
      if (native.width % 2 != 0 || native.height % 2 != 0) return failed("has odd sides, which NV12 cannot");
      cv::cvtColor(rowsOf(native, native.height * 3 / 2, native.width, CV_8UC1, stride), image,
                   cv::COLOR_YUV2RGB_NV12);
      break;
    case NativeFormat::kJpeg:
      return failed("is no raw picture");
  }
  if (image.cols != native.width) image = image.colRange(0, native.width).clone();
  return {image, {}};
}

/// BT.601 in 8-bit fixed point.
struct Yuv {
  int y, u, v;
};
Yuv toYuv(const std::uint8_t* rgb) {
  const int r = rgb[0], g = rgb[1], b = rgb[2];
  return {((66 * r + 129 * g + 25 * b + 128) >> 8) + 16, ((-38 * r - 74 * g + 112 * b + 128) >> 8) + 128,
          ((112 * r - 94 * g - 18 * b + 128) >> 8) + 128};
}

}  // namespace

DecodedImage decodeImage(const PictureView& native) {
  if (native.format == NativeFormat::kJpeg) {
    if (auto problem = jpegProblem(native.bytes); !problem.empty()) return failed(std::move(problem));
    return decodeBytes(native.bytes);
  }
  if (native.width < 1 || native.height < 1 || std::max(native.width, native.height) > kMaxImageSide_px) {
    return failed("has " + std::to_string(native.width) + "x" + std::to_string(native.height) + " pixels");
  }
  const int row = bytesPerRow(native);
  const int stride = native.stride == 0 ? row : native.stride;
  const int rows = native.format == NativeFormat::kNv12 ? native.height * 3 / 2 : native.height;
  // The last row needs no padding after it.
  const std::size_t needed =
      static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows - 1) + static_cast<std::size_t>(row);
  if (stride < row || native.bytes.size() < needed) {
    return failed("has " + std::to_string(native.bytes.size()) + " bytes of " + std::to_string(needed));
  }
  return decodeRaw(native, static_cast<std::size_t>(stride));
}

DecodedImage decodeImageFile(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return failed("is empty");
  if (isJpeg(bytes)) {
    if (auto problem = jpegProblem(bytes); !problem.empty()) return failed(std::move(problem));
  }
  return decodeBytes(bytes);
}

std::vector<std::uint8_t> encodeJpeg(const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> bytes;
  // The encoder expects B, G, R; the frame's own pixels are shared and must not change.
  cv::Mat bgr;
  if (image.channels() == 3) {
    cv::cvtColor(image, bgr, cv::COLOR_RGB2BGR);
  } else {
    bgr = image;
  }
  if (!cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) bytes.clear();
  return bytes;
}

std::vector<std::uint8_t> encodeYuy2(const cv::Mat& image) {
  const cv::Mat rgb = colourPixels(image);
  std::vector<std::uint8_t> bytes(yuy2Bytes(rgb.cols, rgb.rows));
  std::uint8_t* out = bytes.data();
  for (int y = 0; y < rgb.rows; ++y) {
    const std::uint8_t* row = rgb.ptr(y);
    for (int x = 0; x < rgb.cols; x += 2) {
      const Yuv left = toYuv(row + 3 * x);
      const Yuv right = x + 1 < rgb.cols ? toYuv(row + 3 * (x + 1)) : left;
      *out++ = static_cast<std::uint8_t>(left.y);
      *out++ = static_cast<std::uint8_t>((left.u + right.u + 1) / 2);
      *out++ = static_cast<std::uint8_t>(right.y);
      *out++ = static_cast<std::uint8_t>((left.v + right.v + 1) / 2);
    }
  }
  return bytes;
}

std::vector<std::uint8_t> tightBytes(const cv::Mat& image) {
  const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
  std::vector<std::uint8_t> bytes(row * static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) std::memcpy(bytes.data() + row * y, image.ptr(y), row);
  return bytes;
}

cv::Mat colourPixels(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2RGB);
  return colour;
}

cv::Mat grayPixels(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

}  // namespace vismem
