/// @file Video files and network streams, as OpenCV's FFmpeg back end opens them.
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/videoio.hpp>

#include "drivers/camera_files/picture_source.h"

namespace vismem {

class VideoFile : public PictureSource {
 public:
  explicit VideoFile(std::filesystem::path path) : path_(std::move(path)) {}

  std::string name() const override { return "video " + path_.string(); }
  std::string open() override;
  PictureResult read() override;
  void close() override { capture_.release(); }
  double ownRate_hz() const override { return rate_hz_; }

 private:
  const std::filesystem::path path_;
  cv::VideoCapture capture_;
  double rate_hz_ = 0.0;
  std::int64_t read_ = 0;
  std::optional<StampUs> last_us_;
};

/// Streams of rtsp://, http:// and other protocols of FFmpeg. A server without an answer in time counts as
/// away.
class NetworkStream : public PictureSource {
 public:
  struct Timeouts {
    double open_s = 3.0;
    double read_s = 2.0;
  };

  NetworkStream(std::string url, const Timeouts& timeouts) : url_(std::move(url)), timeouts_(timeouts) {}

  /// The address without user name and password.
  std::string name() const override;
  bool isLive() const override { return true; }
  /// Waits up to open_s, and for the name service without a limit.
  std::string open() override;
  /// Waits up to read_s.
  PictureResult read() override;
  void close() override { capture_.release(); }
  double ownRate_hz() const override { return rate_hz_; }

 private:
  const std::string url_;
  const Timeouts timeouts_;
  cv::VideoCapture capture_;
  double rate_hz_ = 0.0;
};

}  // namespace vismem
