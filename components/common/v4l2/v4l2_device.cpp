#include "common/v4l2/v4l2_device.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "common/drivers/device_errors.h"

namespace vismem {
namespace {

/// Text fields of V4L2 have a fixed size and need no terminating zero.
template <std::size_t kSize>
std::string textOf(const __u8 (&field)[kSize]) {
  const char* const text = reinterpret_cast<const char*>(field);
  return {text, strnlen(text, kSize)};
}

}  // namespace

V4l2Device::V4l2Device() : wake_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

V4l2Device::~V4l2Device() {
  close();
  if (wake_fd_ >= 0) ::close(wake_fd_);
}

std::string V4l2Device::open(const std::string& path) {
  close();
  path_ = path;
  identity_ = {};
  fd_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return failed(deviceErrorText(errno, kVideoDevices));
  v4l2_capability found{};
  if (const int error = request(VIDIOC_QUERYCAP, &found); error != 0) {
    close();
    // A device that does not support the request is no video device, whatever its errno.
    return failed(error == EINVAL ? deviceErrorText(ENOTTY, kVideoDevices)
                                  : deviceErrorText(error, kVideoDevices));
  }
  identity_.card = textOf(found.card);
  identity_.driver = textOf(found.driver);
  identity_.bus = textOf(found.bus_info);
  // For a device with several nodes, `capabilities` is the union of all nodes.
  const unsigned can =
      (found.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? found.device_caps : found.capabilities;
  const bool streams = (can & V4L2_CAP_STREAMING) != 0;
  identity_.captures = streams && (can & V4L2_CAP_VIDEO_CAPTURE) != 0;
  identity_.captures_multiplanar = streams && (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
  return {};
}

void V4l2Device::close() {
  if (fd_ < 0) return;
  ::close(fd_);
  fd_ = -1;
}

int V4l2Device::request(unsigned long code, void* argument) const {
  if (fd_ < 0) return ENODEV;
  while (ioctl(fd_, code, argument) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

void* V4l2Device::map(std::size_t bytes, std::int64_t offset) const {
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, offset);
  return memory == MAP_FAILED ? nullptr : memory;
}

std::string V4l2Device::failed(const std::string& what, int error) const {
  // For any request: these errors concern the device.
  if (error == ENODEV || error == ENXIO) return failed("was unplugged");
  if (error == EBUSY || error == EACCES || error == EPERM)
    return failed(deviceErrorText(error, kVideoDevices));
  return failed(what + ": " + std::strerror(error));
}

bool V4l2Device::isThere() const {
  v4l2_capability found{};
  return request(VIDIOC_QUERYCAP, &found) == 0;
}

V4l2Device::Wait V4l2Device::wait(Clock::time_point deadline, bool frame) const {
  while (true) {
    std::array<pollfd, 2> waits{{{wake_fd_, POLLIN, 0}, {fd_, POLLIN, 0}}};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    const int ready = poll(waits.data(), frame ? 2 : 1, static_cast<int>(std::clamp<long>(left, 0, 60'000)));
    if (ready < 0 && errno != EINTR) return Wait::kError;
    if (ready == 0 && Clock::now() >= deadline) return Wait::kDeadline;
    if (ready <= 0) continue;
    if (waits[0].revents != 0) {
      std::uint64_t count = 0;
      static_cast<void>(::read(wake_fd_, &count, sizeof count) == 0);
      return Wait::kWoken;
    }
    // The next request reports an error.
    if (waits[1].revents != 0) return (waits[1].revents & POLLIN) != 0 ? Wait::kReady : Wait::kError;
  }
}

V4l2Device::Wait V4l2Device::waitForFrame(Clock::time_point deadline) const {
  return wait(deadline, true);
}

V4l2Device::Wait V4l2Device::pauseUntil(Clock::time_point deadline) const {
  return wait(deadline, false);
}

void V4l2Device::wake() const {
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_fd_, &one, sizeof one) == 0);
}

}  // namespace vismem
