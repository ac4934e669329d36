/// @file Frames on the wire: formats, encoding once for all clients, decoding with checks. See C4.
#pragma once

#include <avm/camera.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/ports.h"

namespace vismem {

enum class FrameFormat { kRgb8 = 0, kGray8 = 1, kJpeg = 2, kYuy2 = 3 };

/// "RGB8", "GRAY8", "JPEG", "YUY2", in the order of the enum.
const std::vector<std::string>& frameFormatNames();
std::optional<FrameFormat> frameFormatFromName(const std::string& name);
/// "unknown format "BGR8" (known: RGB8, GRAY8, JPEG, YUY2)".
std::string unknownFormat(const std::string& name);

/// One frame with its encodings, each computed at the first request and cached. A native image
/// (Frame::native) is decoded once, at the first request for pixels. A client of the native format receives
/// it unchanged, for example a camera's JPEG. *Thread-safe.*
class EncodedFrame {
 public:
  /// The image must be CV_8UC3 (R, G, B) or CV_8UC1 and immutable; it may be empty only with `native`.
  EncodedFrame(Frame frame, int jpeg_quality);

  /// The published frame; its image may be empty.
  const Frame& frame() const { return frame_; }
  /// In which its picture was captured, or the nearest to it.
  FrameFormat capturedFormat() const;
  int width() const {
    return frame_.image.empty() && frame_.native ? frame_.native->width : frame_.image.cols;
  }
  int height() const {
    return frame_.image.empty() && frame_.native ? frame_.native->height : frame_.image.rows;
  }
  /// kWaiting with the reason if the captured picture cannot be decoded.
  const avm::FrameResult& result(FrameFormat format) const;
  /// Null if the captured picture cannot be decoded.
  std::shared_ptr<jderobot::ImageData> jderobotImage(FrameFormat format) const;
  /// Numbers of encodings so far, and of decodings of the native image.
  int encodings() const;
  int decodings() const;

 private:
  struct Encoding {
    std::mutex mutex;
    std::unique_ptr<const avm::FrameResult> result;
    std::shared_ptr<jderobot::ImageData> image;
  };
  struct Pixels {
    std::once_flag once;
    std::atomic<int> decodings = 0;
    cv::Mat image;  ///< empty if they cannot be had
    std::string error;
  };
  const avm::FrameResult& resultLocked(Encoding& encoding, FrameFormat format) const;
  const Pixels& pixels() const;
  /// @return empty with the reason in `error` if the captured picture cannot be decoded.
  jderobot::ByteSeq encode(FrameFormat format, std::string& error) const;

  Frame frame_;
  int jpeg_quality_;
  mutable Pixels pixels_;
  mutable std::array<Encoding, 4> encodings_;
};

/// @return the frame, or kWaiting with the problem: inconsistent sizes, numbers that are not finite, an
/// unreadable JPEG. Images larger than 16384 pixels on a side are refused.
FrameResult decodeFrame(const avm::FrameResult& result);

}  // namespace vismem
