/// @file Frames on the wire: formats, encoding once for all clients, decoding with checks. SPEC C4.
#pragma once

#include <avm/camera.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/ports.h"

namespace vismem {

enum class FrameFormat { kRgb8 = 0, kGray8 = 1, kJpeg = 2 };

/// "RGB8", "GRAY8", "JPEG", in the order of the enum.
const std::vector<std::string>& frameFormatNames();
std::optional<FrameFormat> frameFormatFromName(const std::string& name);
/// "unknown format "YUY2" (known: RGB8, GRAY8, JPEG)".
std::string unknownFormat(const std::string& name);

/// One frame with its encodings, each made at the first request and kept for the others.
/// *Thread-safe.* Encoding throws cv::Exception for an image that OpenCV cannot encode.
class EncodedFrame {
 public:
  /// The image must be CV_8UC3 (R, G, B) or CV_8UC1 and not be written any more.
  EncodedFrame(Frame frame, int jpeg_quality);

  const Frame& frame() const { return frame_; }
  const avm::FrameResult& result(FrameFormat format) const;
  std::shared_ptr<jderobot::ImageData> jderobotImage(FrameFormat format) const;
  /// How many encodings were made so far.
  int encodings() const;

 private:
  struct Encoding {
    std::mutex mutex;
    std::unique_ptr<const avm::FrameResult> result;
    std::shared_ptr<jderobot::ImageData> image;
  };
  const avm::FrameResult& resultLocked(Encoding& encoding, FrameFormat format) const;

  Frame frame_;
  int jpeg_quality_;
  mutable std::array<Encoding, 3> encodings_;
};

/// @return the frame, or kWaiting with what is wrong: sizes that do not fit, numbers that are not finite, a
/// JPEG that cannot be read. Images larger than 16384 pixels on a side are refused.
FrameResult decodeFrame(const avm::FrameResult& result);

}  // namespace vismem
