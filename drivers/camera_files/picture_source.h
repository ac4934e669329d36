/// @file Where a file camera takes its pictures from, one after the other: a folder, a video, a stream.
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
    kLost,  ///< this one cannot be had, the next may; `message` names it and says why
    kAway,  ///< nothing can be had for now; close and open again later
    kEnd,   ///< of a pass; open again for the next
  };
  Kind kind = Kind::kAway;
  Picture picture;
  std::string message;

  static PictureResult lost(std::string why) { return {Kind::kLost, {}, std::move(why)}; }
  static PictureResult away(std::string why) { return {Kind::kAway, {}, std::move(why)}; }
  static PictureResult end() { return {Kind::kEnd, {}, {}}; }
};

/// Blocking; never throws. *Single-threaded* (owner: the thread of a file camera, or whoever looks at a first
/// picture before that begins).
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  /// For people: "image folder data/walk".
  virtual std::string name() const = 0;
  /// Pictures come when they come, and stamps are those of their arrival: no pace is kept, there is no end.
  virtual bool isLive() const { return false; }
  /// At the beginning. @return why it cannot be had now; empty if it can.
  virtual std::string open() = 0;
  virtual PictureResult read() = 0;
  virtual void close() = 0;
  /// Pictures per second by its own time line, known once open; 0 if it has none.
  virtual double ownRate_hz() const = 0;
};

}  // namespace vismem
