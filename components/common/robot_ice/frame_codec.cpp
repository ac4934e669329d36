#include "common/robot_ice/frame_codec.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/image_codec/image_codec.h"
#include "common/image_codec/jpeg_header.h"
#include "common/robot_ice/conversions.h"
#include "common/robot_ice/md5.h"

namespace vismem {
namespace {

/// The captured format that is a wire format as it stands.
bool isCapturedAs(const NativeImage& native, FrameFormat format) {
  switch (format) {
    case FrameFormat::kRgb8:
      return native.format == NativeFormat::kRgb8;
    case FrameFormat::kGray8:
      return native.format == NativeFormat::kGray8;
    case FrameFormat::kJpeg:
      return native.format == NativeFormat::kJpeg;
    case FrameFormat::kYuy2:
      return native.format == NativeFormat::kYuyv;
  }
  return false;
}

/// Bytes of a raw format without padding; 0 for JPEG.
std::size_t rawBytes(FrameFormat format, int width, int height) {
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  switch (format) {
    case FrameFormat::kRgb8:
      return 3 * pixels;
    case FrameFormat::kGray8:
      return pixels;
    case FrameFormat::kYuy2:
      return yuy2Bytes(width, height);
    case FrameFormat::kJpeg:
      break;
  }
  return 0;
}

/// The native image as bytes on the wire, rows without padding; empty if it has too few bytes.
jderobot::ByteSeq passOn(const NativeImage& native, FrameFormat format) {
  const std::size_t size = rawBytes(format, native.width, native.height);
  if (size == 0) return native.bytes;
  const std::size_t row = size / static_cast<std::size_t>(native.height);
  const std::size_t stride = native.stride == 0 ? row : static_cast<std::size_t>(native.stride);
  if (stride < row || native.bytes.size() < stride * static_cast<std::size_t>(native.height - 1) + row) {
    return {};
  }
  jderobot::ByteSeq bytes(size);
  for (int y = 0; y < native.height; ++y) {
    std::memcpy(bytes.data() + row * y, native.bytes.data() + stride * y, row);
  }
  return bytes;
}

jderobot::ByteSeq encodePixels(const cv::Mat& image, FrameFormat format, int jpeg_quality) {
  switch (format) {
    case FrameFormat::kRgb8:
      return tightBytes(colourPixels(image));
    case FrameFormat::kGray8:
      return tightBytes(grayPixels(image));
    case FrameFormat::kYuy2:
      return encodeYuy2(image);
    case FrameFormat::kJpeg:
      break;
  }
  return encodeJpeg(image, jpeg_quality);
}

/// In the order of FrameFormat.
constexpr std::array<NativeFormat, 4> kNativeFormats{NativeFormat::kRgb8, NativeFormat::kGray8,
                                                     NativeFormat::kJpeg, NativeFormat::kYuyv};

FrameResult unusable(std::string why) {
  return {SourceState::kWaiting, std::nullopt, "unusable frame: " + std::move(why)};
}

}  // namespace

const std::vector<std::string>& frameFormatNames() {
  static const std::vector<std::string> names = {"RGB8", "GRAY8", "JPEG", "YUY2"};
  return names;
}

std::optional<FrameFormat> frameFormatFromName(const std::string& name) {
  const auto& names = frameFormatNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<FrameFormat>(found - names.begin());
}

std::string unknownFormat(const std::string& name) {
  // The name comes from an untrusted client: shortened.
  return "unknown format \"" + name.substr(0, 40) + "\" (known: RGB8, GRAY8, JPEG, YUY2)";
}

EncodedFrame::EncodedFrame(Frame frame, int jpeg_quality)
    : frame_(std::move(frame)), jpeg_quality_(jpeg_quality) {}

const EncodedFrame::Pixels& EncodedFrame::pixels() const {
  std::call_once(pixels_.once, [this] {
    if (!frame_.image.empty() || !frame_.native) {
      pixels_.image = frame_.image;
      if (frame_.image.empty()) pixels_.error = "is empty";
      return;
    }
    ++pixels_.decodings;
    DecodedImage decoded = decodeImage(*frame_.native);
    if (decoded.error.empty() &&
        (decoded.image.cols != frame_.native->width || decoded.image.rows != frame_.native->height)) {
      decoded = {{}, "has another size than announced"};
    }
    pixels_.image = decoded.image;
    pixels_.error = std::move(decoded.error);
  });
  return pixels_;
}

jderobot::ByteSeq EncodedFrame::encode(FrameFormat format, std::string& error) const {
  if (frame_.native && isCapturedAs(*frame_.native, format)) {
    jderobot::ByteSeq bytes = passOn(*frame_.native, format);
    if (!bytes.empty()) return bytes;
  }
  const Pixels& source = pixels();
  if (source.image.empty()) {
    error = source.error;
    return {};
  }
  jderobot::ByteSeq bytes = encodePixels(source.image, format, jpeg_quality_);
  if (bytes.empty()) error = "cannot be encoded as " + frameFormatNames()[static_cast<std::size_t>(format)];
  return bytes;
}

FrameFormat EncodedFrame::capturedFormat() const {
  if (frame_.native) {
    switch (frame_.native->format) {
      case NativeFormat::kJpeg:
        return FrameFormat::kJpeg;
      case NativeFormat::kYuyv:
      case NativeFormat::kUyvy:
        return FrameFormat::kYuy2;
      case NativeFormat::kGray8:
        return FrameFormat::kGray8;
      case NativeFormat::kRgb8:
      case NativeFormat::kNv12:
        return FrameFormat::kRgb8;
    }
  }
  return frame_.image.channels() == 1 ? FrameFormat::kGray8 : FrameFormat::kRgb8;
}

const avm::FrameResult& EncodedFrame::resultLocked(Encoding& encoding, FrameFormat format) const {
  if (encoding.result) return *encoding.result;
  std::string error;
  avm::Frame image;
  image.pixels = encode(format, error);
  if (!error.empty()) {
    encoding.result = std::make_unique<const avm::FrameResult>(
        avm::FrameResult{avm::SourceState::Waiting, "the picture of the camera " + error, {}});
    return *encoding.result;
  }
  image.stampUs = frame_.stamp_us;
  image.seq = static_cast<Ice::Long>(frame_.seq);
  image.format = frameFormatNames()[static_cast<std::size_t>(format)];
  image.width = width();
  image.height = height();
  image.cameraModel = toIce(frame_.intrinsics);
  image.hasCameraPose = frame_.T_robot_camera.has_value();
  image.cameraOnRobot = toIce(frame_.T_robot_camera.value_or(Pose3::Identity()));
  encoding.result = std::make_unique<const avm::FrameResult>(
      avm::FrameResult{avm::SourceState::Running, "", std::move(image)});
  return *encoding.result;
}

const avm::FrameResult& EncodedFrame::result(FrameFormat format) const {
  Encoding& encoding = encodings_[static_cast<std::size_t>(format)];
  const std::lock_guard lock(encoding.mutex);
  return resultLocked(encoding, format);
}

std::shared_ptr<jderobot::ImageData> EncodedFrame::jderobotImage(FrameFormat format) const {
  Encoding& encoding = encodings_[static_cast<std::size_t>(format)];
  const std::lock_guard lock(encoding.mutex);
  if (encoding.image) return encoding.image;
  const avm::FrameResult& result = resultLocked(encoding, format);
  if (result.state != avm::SourceState::Running) return nullptr;
  const avm::Frame& source = result.image;
  auto description = std::make_shared<jderobot::ImageDescription>(source.width, source.height,
                                                                  static_cast<int>(source.pixels.size()),
                                                                  source.format, md5Hex(source.pixels));
  // Floor division keeps the microseconds positive for stamps before the epoch, too.
  Ice::Long useconds = source.stampUs % kSecondUs;
  if (useconds < 0) useconds += kSecondUs;
  const jderobot::Time time{(source.stampUs - useconds) / kSecondUs, useconds};
  encoding.image = std::make_shared<jderobot::ImageData>(time, std::move(description), source.pixels);
  return encoding.image;
}

int EncodedFrame::encodings() const {
  int made = 0;
  for (Encoding& encoding : encodings_) {
    const std::lock_guard lock(encoding.mutex);
    if (encoding.result) ++made;
  }
  return made;
}

int EncodedFrame::decodings() const {
  return pixels_.decodings;
}

FrameResult decodeFrame(const avm::FrameResult& result) {
  if (result.state != avm::SourceState::Running) return {fromIce(result.state), std::nullopt, result.message};
  const avm::Frame& source = result.image;
  const auto format = frameFormatFromName(source.format);
  if (!format) return unusable(unknownFormat(source.format));
  if (source.width < 1 || source.height < 1 || source.width > kMaxImageSide_px ||
      source.height > kMaxImageSide_px) {
    return unusable("size " + std::to_string(source.width) + "x" + std::to_string(source.height) +
                    " (must be 1..16384)");
  }
  Frame frame;
  frame.stamp_us = source.stampUs;
  frame.seq = static_cast<std::uint64_t>(source.seq);
  if (*format == FrameFormat::kJpeg) {
    // The header alone has the size, before memory is allocated.
    const JpegHeader header = readJpegHeader(source.pixels);
    if (!header.error.empty()) return unusable("the image " + header.error);
    if (header.width != source.width || header.height != source.height) {
      return unusable("the JPEG image has another size than announced");
    }
  } else if (const auto expected = rawBytes(*format, source.width, source.height);
             source.pixels.size() != expected) {
    return unusable(std::to_string(source.pixels.size()) + " bytes (must be " + std::to_string(expected) +
                    ")");
  }
  DecodedImage decoded = decodeImage(PictureView(kNativeFormats[static_cast<std::size_t>(*format)],
                                                 source.width, source.height, 0, source.pixels));
  if (!decoded.error.empty()) return unusable("the image " + decoded.error);
  frame.image = std::move(decoded.image);
  const avm::Intrinsics& c = source.cameraModel;
  if (!allFinite({c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3})) {
    return unusable("the camera model is not finite");
  }
  frame.intrinsics = fromIce(c);
  if (source.hasCameraPose) {
    frame.T_robot_camera = fromIce(source.cameraOnRobot);
    if (!frame.T_robot_camera) return unusable("the camera's pose is not a rigid one");
  }
  return {SourceState::kRunning, std::move(frame), {}};
}

}  // namespace vismem
