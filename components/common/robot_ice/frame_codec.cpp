#include "common/robot_ice/frame_codec.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/robot_ice/conversions.h"
#include "common/robot_ice/md5.h"

namespace vismem {
namespace {

constexpr int kMaxSide_px = 16384;

jderobot::ByteSeq packed(const cv::Mat& image) {
  const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
  jderobot::ByteSeq bytes(row * static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) std::memcpy(bytes.data() + row * y, image.ptr(y), row);
  return bytes;
}

jderobot::ByteSeq encode(const cv::Mat& image, FrameFormat format, int jpeg_quality) {
  const bool gray = image.channels() == 1;
  cv::Mat converted;
  switch (format) {
    case FrameFormat::kRgb8:
      if (!gray) return packed(image);
      cv::cvtColor(image, converted, cv::COLOR_GRAY2RGB);
      return packed(converted);
    case FrameFormat::kGray8:
      if (gray) return packed(image);
      cv::cvtColor(image, converted, cv::COLOR_RGB2GRAY);
      return packed(converted);
    case FrameFormat::kJpeg:
      break;
  }
  // The encoder takes colour as B, G, R.
  if (!gray) cv::cvtColor(image, converted, cv::COLOR_RGB2BGR);
  jderobot::ByteSeq bytes;
  cv::imencode(".jpg", gray ? image : converted, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
  return bytes;
}

FrameResult unusable(std::string why) {
  return {SourceState::kWaiting, std::nullopt, "unusable frame: " + std::move(why)};
}

}  // namespace

const std::vector<std::string>& frameFormatNames() {
  static const std::vector<std::string> names = {"RGB8", "GRAY8", "JPEG"};
  return names;
}

std::optional<FrameFormat> frameFormatFromName(const std::string& name) {
  const auto& names = frameFormatNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<FrameFormat>(found - names.begin());
}

std::string unknownFormat(const std::string& name) {
  // The name is a stranger's: not more of it than helps.
  return "unknown format \"" + name.substr(0, 40) + "\" (known: RGB8, GRAY8, JPEG)";
}

EncodedFrame::EncodedFrame(Frame frame, int jpeg_quality)
    : frame_(std::move(frame)), jpeg_quality_(jpeg_quality) {}

const avm::FrameResult& EncodedFrame::resultLocked(Encoding& encoding, FrameFormat format) const {
  if (encoding.result) return *encoding.result;
  avm::Frame image;
  image.stampUs = frame_.stamp_us;
  image.seq = static_cast<Ice::Long>(frame_.seq);
  image.format = frameFormatNames()[static_cast<std::size_t>(format)];
  image.width = frame_.image.cols;
  image.height = frame_.image.rows;
  image.cameraModel = toIce(frame_.intrinsics);
  image.hasCameraPose = frame_.T_robot_camera.has_value();
  image.cameraOnRobot = toIce(frame_.T_robot_camera.value_or(Pose3::Identity()));
  image.pixels = encode(frame_.image, format, jpeg_quality_);
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
  const avm::Frame& source = resultLocked(encoding, format).image;
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

FrameResult decodeFrame(const avm::FrameResult& result) {
  if (result.state != avm::SourceState::Running) return {fromIce(result.state), std::nullopt, result.message};
  const avm::Frame& source = result.image;
  const auto format = frameFormatFromName(source.format);
  if (!format) return unusable(unknownFormat(source.format));
  if (source.width < 1 || source.height < 1 || source.width > kMaxSide_px || source.height > kMaxSide_px) {
    return unusable("size " + std::to_string(source.width) + "x" + std::to_string(source.height) +
                    " (must be 1..16384)");
  }
  Frame frame;
  frame.stamp_us = source.stampUs;
  frame.seq = static_cast<std::uint64_t>(source.seq);
  if (*format == FrameFormat::kJpeg) {
    cv::Mat decoded;
    if (!source.pixels.empty()) decoded = cv::imdecode(source.pixels, cv::IMREAD_ANYCOLOR);
    if (decoded.empty()) return unusable("the JPEG image cannot be read");
    if (decoded.channels() == 3) cv::cvtColor(decoded, decoded, cv::COLOR_BGR2RGB);
    frame.image = decoded;
  } else {
    const int type = *format == FrameFormat::kRgb8 ? CV_8UC3 : CV_8UC1;
    frame.image.create(source.height, source.width, type);
    const std::size_t expected = frame.image.total() * frame.image.elemSize();
    if (source.pixels.size() != expected) {
      return unusable(std::to_string(source.pixels.size()) + " bytes (must be " + std::to_string(expected) +
                      ")");
    }
    std::memcpy(frame.image.data, source.pixels.data(), expected);
  }
  if (frame.image.cols != source.width || frame.image.rows != source.height) {
    return unusable("the JPEG image has another size than announced");
  }
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
