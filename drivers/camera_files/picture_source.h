/// @file The source of a file camera's images: a folder, a video, a stream.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/robot/samples.h"

namespace vismem {

struct Picture {
  cv::Mat image;                              ///< as Frame::image; may be empty if `native` is there
  std::shared_ptr<const NativeImage> native;  ///< the file's own JPEG
  /// On the source's own time line (a stamp file, a video's position); rises within one pass.
  std::optional<StampUs> own_us;
  std::string name;  ///< for people: the file

  int width() const { return image.empty() && native ? native->width : image.cols; }
  int height() const { return image.empty() && native ? native->height : image.rows; }
};

struct PictureResult {
  enum class Kind {
    kPicture,
    kLost,  ///< this image is unreadable, the next may be readable; `message` has its name and the reason
    kAway,  ///< no images for now; close and open again later
    kEnd,   ///< of a pass; open again for the next
  };
  Kind kind = Kind::kAway;
  Picture picture;
  std::string message;

  static PictureResult lost(std::string why) { return {Kind::kLost, {}, std::move(why)}; }
  static PictureResult away(std::string why) { return {Kind::kAway, {}, std::move(why)}; }
  static PictureResult end() { return {Kind::kEnd, {}, {}}; }
};

/// Blocking; never throws. *Single-threaded* (owner: the thread of a file camera, or the reader of a first
/// image before that thread starts).
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// For people: "image folder data/walk".
  virtual std::string name() const = 0;
  /// Images are delivered at their arrival, which is their stamp: the source has no rate and no end.
  virtual bool isLive() const { return false; }
  /// Opens the source at its beginning.
  /// @return the reason of a failure; empty without one.
  virtual std::string open() = 0;
  virtual PictureResult read() = 0;
  virtual void close() = 0;
  /// Pictures per second by its own time line, known once open; 0 if it has none.
  virtual double ownRate_hz() const = 0;
};

}  // namespace vismem
