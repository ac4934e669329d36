/// @file Encoding and decoding of images between the formats of devices, pixels and clients. Pure. An image
/// is CV_8UC3 in the order R, G, B, or CV_8UC1, as in Frame.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

struct DecodedImage {
  cv::Mat image;      ///< empty if it failed
  std::string error;  ///< "is a JPEG file cut short": follows the image's name in messages
};

/// A non-owning view of a native image; fields as in NativeImage.
struct PictureView {
  NativeFormat format;
  int width;
  int height;
  int stride;
  std::span<const std::uint8_t> bytes;

  PictureView(NativeFormat f, int w, int h, int s, std::span<const std::uint8_t> b)
      : format(f), width(w), height(h), stride(s), bytes(b) {}
  PictureView(const NativeImage& n)  // NOLINT(google-explicit-constructor): every NativeImage is one
      : PictureView(n.format, n.width, n.height, n.stride, n.bytes) {}
};

/// Decodes a native image into pixels of its own; never throws. The orientation tag of a JPEG is ignored,
/// because camera models refer to the sensor. Colour spaces as in NativeFormat.
DecodedImage decodeImage(const PictureView& native);

/// Decodes a whole file (JPEG, PNG, PNM, TIFF ...) into pixels of 8 bits; grey images stay grey.
DecodedImage decodeImageFile(std::span<const std::uint8_t> bytes);

/// @param quality 1..100.
/// @return empty for an image that cannot be encoded.
std::vector<std::uint8_t> encodeJpeg(const cv::Mat& image, int quality);

/// Size of an image in YUY2 [bytes]: rows of (width + 1) / 2 pairs of 4 bytes.
constexpr std::size_t yuy2Bytes(int width, int height) {
  return static_cast<std::size_t>((width + 1) / 2) * 4 * static_cast<std::size_t>(height);
}

/// Y0 U Y1 V without padding, BT.601 with Y in 16..235, colour differences averaged over a pair. Of an odd
/// width the last pixel is paired with itself, so that a row has (width + 1) / 2 pairs.
std::vector<std::uint8_t> encodeYuy2(const cv::Mat& image);

/// Row by row without padding, in the image's own channels.
std::vector<std::uint8_t> tightBytes(const cv::Mat& image);

cv::Mat colourPixels(const cv::Mat& image);
cv::Mat grayPixels(const cv::Mat& image);

}  // namespace vismem
