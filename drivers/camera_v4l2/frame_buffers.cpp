#include "drivers/camera_v4l2/frame_buffers.h"

#include <linux/videodev2.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>

namespace vismem::v4l2 {
namespace {

/// One being filled, one filled, and two for delays of the thread.
constexpr unsigned kBuffers = 4;

v4l2_buffer bufferOf(unsigned index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

std::string FrameBuffers::lost(const std::string& what, int error) const {
  // An unplugged camera answers ENODEV, or EINVAL or EIO while its buffers are being removed.
  return device_.isThere() ? device_.failed(what, error) : device_.failed("was unplugged");
}

std::string FrameBuffers::begin() {
  v4l2_requestbuffers request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  request.count = kBuffers;
  if (const int error = device_.request(VIDIOC_REQBUFS, &request); error != 0) {
    return lost("gives no buffers", error);
  }
  if (request.count < 2) return device_.failed("gives too few buffers");
  for (unsigned i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = bufferOf(i);
    if (const int error = device_.request(VIDIOC_QUERYBUF, &buffer); error != 0) {
      return lost("describes no buffer", error);
    }
    void* const memory = device_.map(buffer.length, buffer.m.offset);
    if (memory == nullptr) return lost("its buffers cannot be mapped", errno);
    memory_.push_back({memory, buffer.length});
    if (std::string why = queue(i); !why.empty()) return why;
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const int error = device_.request(VIDIOC_STREAMON, &type);
  // Cameras share the bandwidth of the USB bus; the kernel reports with ENOSPC that it is exhausted.
  if (error == ENOSPC) return device_.failed("the USB bus has no bandwidth left for this size and rate");
  return error == 0 ? std::string() : lost("does not begin to stream", error);
}

void FrameBuffers::end() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!memory_.empty()) device_.request(VIDIOC_STREAMOFF, &type);
  for (const Memory& memory : memory_) munmap(memory.begin, memory.bytes);
  if (memory_.empty()) return;
  memory_.clear();
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  device_.request(VIDIOC_REQBUFS, &none);
}

std::string FrameBuffers::queue(unsigned index) {
  v4l2_buffer buffer = bufferOf(index);
  const int error = device_.request(VIDIOC_QBUF, &buffer);
  return error == 0 ? std::string() : lost("takes no buffer back", error);
}

FrameBuffers::Taken FrameBuffers::take(Filled& filled, std::string& why) {
  v4l2_buffer buffer = bufferOf(0);
  const int error = device_.request(VIDIOC_DQBUF, &buffer);
  if (error == EAGAIN) return Taken::kNone;
  if (error != 0) {
    why = lost("gives no picture", error);
    return Taken::kLost;
  }
  if (buffer.index >= memory_.size()) {
    why = device_.failed("gives a buffer that it does not have");
    return Taken::kLost;
  }
  const Memory& memory = memory_[buffer.index];
  filled.index = buffer.index;
  filled.bytes = {static_cast<const std::uint8_t*>(memory.begin),
                  std::min<std::size_t>(buffer.bytesused, memory.bytes)};
  filled.sequence = buffer.sequence;
  filled.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  filled.monotonic_us =
      monotonic ? std::int64_t{1'000'000} * buffer.timestamp.tv_sec + buffer.timestamp.tv_usec : 0;
  return Taken::kFrame;
}

std::string FrameBuffers::giveBack(const Filled& filled) {
  return queue(filled.index);
}

}  // namespace vismem::v4l2
