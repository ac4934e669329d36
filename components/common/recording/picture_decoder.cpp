#include "common/recording/picture_decoder.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "common/config/text_format.h"
#include "common/image_codec/image_codec.h"
#include "common/image_codec/jpeg_header.h"
#include "common/robot/ports.h"

namespace vismem {
namespace {

constexpr int kPlain = -1;
constexpr int kYuv = -2;

/// How an encoding becomes pixels: `code` of cv::cvtColor, kPlain or kYuv.
struct Encoding {
  const char* name;
  int channels;
  int code;
};
/// ROS names a Bayer pattern by its first two rows, OpenCV by its second.
constexpr std::array<Encoding, 12> kEncodings{{{"rgb8", 3, kPlain},
                                               {"bgr8", 3, cv::COLOR_BGR2RGB},
                                               {"rgba8", 4, cv::COLOR_RGBA2RGB},
                                               {"bgra8", 4, cv::COLOR_BGRA2RGB},
                                               {"mono8", 1, kPlain},
                                               {"bayer_rggb8", 1, cv::COLOR_BayerBG2RGB},
                                               {"bayer_bggr8", 1, cv::COLOR_BayerRG2RGB},
                                               {"bayer_gbrg8", 1, cv::COLOR_BayerGR2RGB},
                                               {"bayer_grbg8", 1, cv::COLOR_BayerGB2RGB},
                                               {"yuv422", 2, kYuv},
                                               {"yuv422_yuy2", 2, kYuv},
                                               {"yuyv", 2, kYuv}}};

const Encoding* findEncoding(const std::string& name) {
  const auto found = std::find_if(kEncodings.begin(), kEncodings.end(),
                                  [&](const Encoding& encoding) { return name == encoding.name; });
  return found == kEncodings.end() ? nullptr : &*found;
}

NativeFormat yuvFormat(const std::string& encoding) {
  return encoding == "yuv422" ? NativeFormat::kUyvy : NativeFormat::kYuyv;
}

/// Bytes of a row without padding.
std::size_t rowBytes(const Encoding& encoding, int width) {
  const auto w = static_cast<std::size_t>(width);
  return encoding.code == kYuv ? (w + 1) / 2 * 4 : w * static_cast<std::size_t>(encoding.channels);
}

void checkSize(const BagImage& picture, const Encoding& encoding) {
  const BagImageHeader& h = picture.header;
  const bool sides =
      h.width > 0 && h.height > 0 && h.width <= kMaxImageSide_px && h.height <= kMaxImageSide_px;
  if (sides && picture.step >= rowBytes(encoding, h.width) &&
      picture.step <= static_cast<std::size_t>(16 * kMaxImageSide_px) &&
      picture.data.size() >= picture.step * static_cast<std::size_t>(h.height)) {
    return;
  }
  throw RecordingError("has " + std::to_string(picture.data.size()) + " bytes, " +
                       std::to_string(picture.step) + " a row (expected " + std::to_string(h.width) + "x" +
                       std::to_string(h.height) + " pixels of " + h.encoding + ")");
}

cv::Mat decodeCompressed(const BagImage& picture) {
  const DecodedImage decoded = picture.data.empty() ? DecodedImage{} : decodeImageFile(picture.data);
  if (decoded.image.empty()) {
    throw RecordingError("(" + picture.header.encoding + ", " + std::to_string(picture.data.size()) +
                         " bytes) cannot be decoded (expected JPEG or PNG)");
  }
  return decoded.image;
}

}  // namespace

std::string knownEncodings() {
  return joined(kEncodings, ", ", &Encoding::name);
}

bool isKnownEncoding(const std::string& encoding) {
  return findEncoding(encoding) != nullptr;
}

cv::Mat decodePicture(const BagImage& picture) {
  if (picture.header.compressed) return decodeCompressed(picture);
  const Encoding* encoding = findEncoding(picture.header.encoding);
  if (encoding == nullptr) {
    throw RecordingError("has the encoding \"" + picture.header.encoding + "\" (expected " +
                         knownEncodings() + ")");
  }
  checkSize(picture, *encoding);
  const BagImageHeader& h = picture.header;
  if (encoding->code == kYuv) {
    DecodedImage decoded = decodeImage(
        {yuvFormat(h.encoding), h.width, h.height, static_cast<int>(picture.step), std::span(picture.data)});
    if (decoded.image.empty()) throw RecordingError(decoded.error);
    return decoded.image;
  }
  const cv::Mat view(h.height, h.width, CV_8UC(encoding->channels),
                     const_cast<std::uint8_t*>(picture.data.data()), picture.step);
  if (encoding->code == kPlain) return view.clone();
  if (encoding->code >= cv::COLOR_BayerBG2BGR && encoding->channels == 1 && (h.width < 2 || h.height < 2)) {
    throw RecordingError("is too small for a Bayer pattern: " + std::to_string(h.width) + "x" +
                         std::to_string(h.height));
  }
  cv::Mat rgb;
  cv::cvtColor(view, rgb, encoding->code);
  return rgb;
}

std::optional<cv::Size> pictureSize(const BagImage& picture) {
  if (!picture.header.compressed) return cv::Size(picture.header.width, picture.header.height);
  // A PNG begins with 8 bytes of its own, the length and name of its first chunk, width and height.
  constexpr std::array<std::uint8_t, 8> kPng{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const Bytes& data = picture.data;
  if (data.size() >= 24 && std::equal(kPng.begin(), kPng.end(), data.begin())) {
    const auto side = [&](std::size_t at) {
      return static_cast<int>((data[at] & 0x3Fu) << 24 | data[at + 1] << 16 | data[at + 2] << 8 |
                              data[at + 3]);
    };
    return cv::Size(side(16), side(20));
  }
  const JpegHeader jpeg = readJpegHeader(data);
  if (!jpeg.error.empty()) return std::nullopt;
  return cv::Size(jpeg.width, jpeg.height);
}

std::shared_ptr<const NativeImage> nativePicture(const BagImage& picture) {
  const BagImageHeader& h = picture.header;
  if (h.compressed) {
    const JpegHeader jpeg = readJpegHeader(picture.data);
    if (!jpeg.error.empty()) return nullptr;
    return std::make_shared<NativeImage>(
        NativeImage{NativeFormat::kJpeg, jpeg.width, jpeg.height, 0, picture.data});
  }
  const Encoding* encoding = findEncoding(h.encoding);
  if (encoding == nullptr || encoding->code != kYuv) return nullptr;
  checkSize(picture, *encoding);
  return std::make_shared<NativeImage>(
      NativeImage{yuvFormat(h.encoding), h.width, h.height, static_cast<int>(picture.step), picture.data});
}

}  // namespace vismem
