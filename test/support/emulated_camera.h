/// @file A camera of V4L2 for tests of its driver, on umockdev: its ioctls, and buffers in a file that stands
/// for the device. poll and time-outs of the kernel are not emulated: poll always reports an image.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "support/emulated_node.h"

namespace vismem {

class EmulatedCamera {
 public:
  struct Mode {
    std::string fourcc;  ///< "YUYV"
    int width = 0;
    int height = 0;
    std::vector<int> rates_hz;
    /// Sizes from 16x16 up to this in steps of 16, as some converters have it.
    bool in_steps = false;
  };
  struct Control {
    std::uint32_t id = 0;
    std::string title;  ///< "Exposure Time, Absolute"
    int type = 1;       ///< V4L2_CTRL_TYPE_INTEGER
    int minimum = 0;
    int maximum = 255;
    int step = 1;
    int value = 0;
    bool write_only = false;  ///< reading gives EACCES
  };
  struct Description {
    int number = 0;  ///< /dev/videoNUMBER
    std::string card = "Emulated Camera";
    std::vector<Mode> modes = {{"YUYV", 320, 240, {50, 30, 15}},
                               {"YUYV", 640, 480, {30, 15}},
                               {"MJPG", 320, 240, {50, 30}},
                               {"MJPG", 1280, 720, {30}},
                               {"YUYV", 1280, 720, {10}}};
    std::vector<Control> controls;
    /// It turns as Logitech's Orbit: by an extension unit that must be registered with the kernel.
    bool orbit = false;
    bool captures = true;  ///< else it is a node of another kind, such as uvcvideo's for metadata
  };

  /// Plugged in.
  explicit EmulatedCamera(Description description);
  EmulatedCamera() : EmulatedCamera(Description()) {}
  ~EmulatedCamera();

  std::string path() const { return "/dev/video" + std::to_string(description_.number); }
  void unplug();
  void plugIn();

  /// Stops the images of a stream, and resumes them.
  void hush(bool silent = true);
  /// Requests of this code fail with this error, until 0; VIDIOC_DQBUF fails for images.
  void fail(unsigned long code, int error);
  /// The next picture: flagged as damaged; with half its bytes.
  void damageNext();
  void shortenNext();
  /// Motion JPEG of some cameras: without tables, and with surplus bytes at its end.
  void setBareJpeg(bool bare);
  /// The stamps belong to an unknown clock.
  void setUnknownClock(bool unknown);
  /// Replaces the size of a mode, as cameras whose modes differ from their list.
  void overrideSize(int width, int height);

  /// Its motors do not follow any more.
  void jam(bool jammed);

  bool streaming();
  /// An Orbit's angle from its zero [1/64 degree], of PAN or TILT_RELATIVE.
  int turned(std::uint32_t id);
  /// Value of a control; how often it was set.
  int control(std::uint32_t id);
  int timesSet(std::uint32_t id);
  void setControl(std::uint32_t id, int value);
  /// Bytes of the last delivered image, and its time.
  std::vector<std::uint8_t> lastPicture();
  std::chrono::steady_clock::time_point lastGivenAt();
  /// The grey that all pixels of the picture with this number have; by formats with range 16..235 as Y.
  static int shadeOf(std::uint32_t sequence) { return 40 + static_cast<int>(sequence % 100); }

 private:
  using Clock = std::chrono::steady_clock;
  using Argument = std::function<IoctlMemory(std::size_t)>;

  IoctlAnswer handle(unsigned code, const Argument& argument);
  IoctlAnswer describe(unsigned code, const Argument& argument);
  IoctlAnswer configure(unsigned code, const Argument& argument);
  IoctlAnswer stream(unsigned code, const Argument& argument);
  IoctlAnswer mapExtension(const Argument& argument);
  IoctlAnswer controls(unsigned code, const Argument& argument);
  IoctlAnswer dequeue(const Argument& argument);
  std::vector<Mode> modesOf(const std::string& fourcc) const;
  int set(std::uint32_t id, int value);
  Control* findControl(std::uint32_t id);
  void openMemory();

  Description description_;
  std::mutex mutex_;
  Mode current_;  ///< with one rate
  int forced_width_ = 0, forced_height_ = 0;
  bool streaming_ = false;
  bool hushed_ = false;
  bool jammed_ = false;
  std::map<std::uint32_t, int> turned_;
  bool damage_ = false;
  bool shorten_ = false;
  bool bare_jpeg_ = false;
  bool unknown_clock_ = false;
  std::map<unsigned long, int> failures_;
  std::map<std::uint32_t, int> times_set_;
  Clock::time_point began_;
  std::int64_t given_ = 0;
  std::vector<unsigned> queued_;
  std::vector<std::uint8_t> last_;
  Clock::time_point last_given_at_;
  int memory_fd_ = -1;
  std::uint8_t* memory_ = nullptr;
  std::unique_ptr<EmulatedNode> node_;
};

}  // namespace vismem
