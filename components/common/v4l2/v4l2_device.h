/// @file A device of Linux's video interface (V4L2): a camera, or the motor of one.
#pragma once

#include <chrono>
#include <string>

namespace vismem {

/// Identity that a device reports.
struct V4l2Identity {
  std::string card;       ///< for people: "HD Webcam C615"
  std::string driver;     ///< "uvcvideo"
  std::string bus;        ///< its place on the bus: "usb-0000:00:14.0-2"
  bool captures = false;  ///< single-planar video with streaming, as of USB cameras
  bool captures_multiplanar = false;
};

/// One open device. *Single-threaded*, but for wake().
class V4l2Device {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Wait { kReady, kDeadline, kWoken, kError };

  V4l2Device();
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  /// Opens a device, after closing an open one.
  /// @param path such as "/dev/video0"; symbolic links are followed.
  /// @return empty, or the reason of the failure: "/dev/video0: no such device", "... no permission ...",
  /// "... not a video device".
  std::string open(const std::string& path);
  void close();
  bool isOpen() const { return fd_ >= 0; }
  const V4l2Identity& identity() const { return identity_; }
  const std::string& path() const { return path_; }

  /// An ioctl, repeated where a signal interrupts it.
  /// @return 0 or the errno.
  int request(unsigned long code, void* argument) const;
  /// @return nullptr if the device's memory cannot be mapped.
  void* map(std::size_t bytes, std::int64_t offset) const;
  /// @return "PATH: WHAT".
  std::string failed(const std::string& what) const { return path_ + ": " + what; }
  /// @return "PATH: WHAT: reason", with a message for the errno of a request.
  std::string failed(const std::string& what, int error) const;
  /// Whether the device still answers; false after it was unplugged.
  bool isThere() const;

  /// Waits until a frame is available.
  Wait waitForFrame(Clock::time_point deadline) const;
  /// Waits until wake() only.
  Wait pauseUntil(Clock::time_point deadline) const;
  /// Ends a wait, or the next one, at once. Any thread.
  void wake() const;

 private:
  Wait wait(Clock::time_point deadline, bool frame) const;

  std::string path_;
  int fd_ = -1;
  int wake_fd_ = -1;
  V4l2Identity identity_;
};

}  // namespace vismem
