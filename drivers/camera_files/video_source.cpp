#include "drivers/camera_files/video_source.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <opencv2/imgproc.hpp>

namespace vismem {
namespace {

/// FFmpeg writes several lines about every failed attempt to stderr; the reason is returned anyway. Setting
/// the variable shows all lines. To be called before OpenCV opens its first video.
void quietFfmpeg() {
  static std::once_flag once;
  std::call_once(once, [] {
    constexpr int kKeep = 0;
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", kKeep);
  });
}

/// OpenCV may report an implausible rate of a video.
double plausibleRate(double rate_hz) {
  return std::isfinite(rate_hz) && rate_hz > 0.01 && rate_hz <= 1000.0 ? rate_hz : 0.0;
}

PictureResult pictureOf(const cv::Mat& bgr, std::string name, std::optional<StampUs> own_us) {
  Picture picture;
  if (bgr.channels() == 1) {
    picture.image = bgr.clone();
  } else {
    cv::cvtColor(bgr, picture.image, cv::COLOR_BGR2RGB);
  }
  picture.name = std::move(name);
  picture.own_us = own_us;
  return {PictureResult::Kind::kPicture, std::move(picture), {}};
}

int milliseconds(double seconds) {
  return static_cast<int>(std::lround(seconds * 1e3));
}

}  // namespace

std::string VideoFile::open() {
  quietFfmpeg();
  std::error_code error;
  if (!std::filesystem::exists(path_, error)) return path_.string() + ": no such file";
  read_ = 0;
  last_us_.reset();
  try {
    if (!capture_.open(path_.string(), cv::CAP_FFMPEG)) return path_.string() + ": is no video";
  } catch (const cv::Exception& failure) {
    return path_.string() + ": " + failure.err;
  }
  rate_hz_ = plausibleRate(capture_.get(cv::CAP_PROP_FPS));
  return {};
}

PictureResult VideoFile::read() {
  cv::Mat bgr;
  try {
    if (!capture_.read(bgr) || bgr.empty()) {
      if (read_ == 0) return PictureResult::away(path_.string() + ": no picture of it can be decoded");
      return PictureResult::end();
    }
  } catch (const cv::Exception& failure) {
    return PictureResult::away(path_.string() + ": " + failure.err);
  }
  // The position of this image; formats without positions use the rate.
  StampUs own_us = static_cast<StampUs>(std::llround(capture_.get(cv::CAP_PROP_POS_MSEC) * 1e3));
  if (last_us_ && own_us <= *last_us_) {
    own_us = *last_us_ + (rate_hz_ > 0.0 ? toStampUs(1.0 / rate_hz_) : 1);
  }
  last_us_ = own_us;
  ++read_;
  return pictureOf(bgr, path_.string(), own_us);
}

std::string NetworkStream::name() const {
  const std::size_t begin = url_.find("://");
  const std::size_t at = begin == std::string::npos ? begin : url_.find('@', begin);
  if (at == std::string::npos || at > url_.find('/', begin + 3)) return "stream " + url_;
  return "stream " + url_.substr(0, begin + 3) + url_.substr(at + 1);
}

std::string NetworkStream::open() {
  quietFfmpeg();
  try {
    const std::vector<int> options{cv::CAP_PROP_OPEN_TIMEOUT_MSEC, milliseconds(timeouts_.open_s),
                                   cv::CAP_PROP_READ_TIMEOUT_MSEC, milliseconds(timeouts_.read_s)};
    if (!capture_.open(url_, cv::CAP_FFMPEG, options)) return name() + ": cannot be opened";
  } catch (const cv::Exception& failure) {
    return name() + ": " + failure.err;
  }
  rate_hz_ = plausibleRate(capture_.get(cv::CAP_PROP_FPS));
  return {};
}

PictureResult NetworkStream::read() {
  cv::Mat bgr;
  try {
    if (!capture_.read(bgr) || bgr.empty()) return PictureResult::away(name() + ": no more pictures come");
  } catch (const cv::Exception& failure) {
    return PictureResult::away(name() + ": " + failure.err);
  }
  return pictureOf(bgr, name(), std::nullopt);
}

}  // namespace vismem
