#include "support/emulated_camera.h"

#include <fcntl.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "support/emulated_picture.h"

namespace vismem {
namespace {

constexpr unsigned kMostBuffers = 8;
/// Of each buffer: holds 1280x720 in every format, and is a whole number of pages.
constexpr std::size_t kBufferBytes = 1U << 22U;

std::uint32_t codeOf(const std::string& fourcc) {
  return v4l2_fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]);
}

template <typename Field>
void put(Field& field, const std::string& text) {
  std::memset(&field, 0, sizeof field);
  std::memcpy(&field, text.data(), std::min(text.size(), sizeof field - 1));
}

int bytesPerLine(const std::string& fourcc, int width) {
  if (fourcc == "MJPG") return 0;
  if (fourcc == "YUYV" || fourcc == "UYVY") return 2 * width;
  return fourcc == "RGB3" || fourcc == "BGR3" ? 3 * width : width;
}

EmulatedNode::Description describeNode(int number) {
  const std::string name = "video" + std::to_string(number);
  const std::string device = "/devices/platform/cam" + std::to_string(number) + "/video4linux/" + name;
  // Without "N:": the node would be a terminal, which cannot be mapped. A file takes its place (openMemory).
  return {"/sys" + device, "/dev/" + name,
          "P: " + device + "\nE: DEVNAME=/dev/" + name +
              "\nE: SUBSYSTEM=video4linux\nE: MAJOR=81\nE: MINOR=" + std::to_string(number) +
              "\nA: dev=81:" + std::to_string(number) + "\\n\n\n"};
}

}  // namespace

EmulatedCamera::EmulatedCamera(Description description) : description_(std::move(description)) {
  current_ = description_.modes.front();
  current_.rates_hz.resize(1);
  node_ = std::make_unique<EmulatedNode>(
      describeNode(description_.number),
      [this](unsigned code, const Argument& argument) { return handle(code, argument); });
  plugIn();
}

EmulatedCamera::~EmulatedCamera() {
  node_.reset();
  if (memory_ != nullptr) munmap(memory_, kMostBuffers * kBufferBytes);
  if (memory_fd_ >= 0) ::close(memory_fd_);
}

void EmulatedCamera::plugIn() {
  if (node_->plugged()) return;
  node_->plugIn();
  openMemory();
}

void EmulatedCamera::unplug() {
  node_->unplug();
  ::unlink(node_->realPath().c_str());
  const std::lock_guard lock(mutex_);
  streaming_ = false;
  queued_.clear();
}

void EmulatedCamera::openMemory() {
  const std::lock_guard lock(mutex_);
  if (memory_ != nullptr) munmap(memory_, kMostBuffers * kBufferBytes);
  if (memory_fd_ >= 0) ::close(memory_fd_);
  const std::string path = node_->realPath();
  memory_fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (memory_fd_ < 0 || ftruncate(memory_fd_, kMostBuffers * kBufferBytes) != 0) {
    throw std::runtime_error(path + ": " + std::strerror(errno));
  }
  void* const memory =
      mmap(nullptr, kMostBuffers * kBufferBytes, PROT_READ | PROT_WRITE, MAP_SHARED, memory_fd_, 0);
  if (memory == MAP_FAILED) throw std::runtime_error(path + ": " + std::strerror(errno));
  memory_ = static_cast<std::uint8_t*>(memory);
}

void EmulatedCamera::hush(bool silent) {
  const std::lock_guard lock(mutex_);
  hushed_ = silent;
}
void EmulatedCamera::fail(unsigned long code, int error) {
  const std::lock_guard lock(mutex_);
  failures_[code & 0xFFFFFFFFU] = error;
}
void EmulatedCamera::damageNext() {
  const std::lock_guard lock(mutex_);
  damage_ = true;
}
void EmulatedCamera::shortenNext() {
  const std::lock_guard lock(mutex_);
  shorten_ = true;
}
void EmulatedCamera::setBareJpeg(bool bare) {
  const std::lock_guard lock(mutex_);
  bare_jpeg_ = bare;
}
void EmulatedCamera::setUnknownClock(bool unknown) {
  const std::lock_guard lock(mutex_);
  unknown_clock_ = unknown;
}
void EmulatedCamera::overrideSize(int width, int height) {
  const std::lock_guard lock(mutex_);
  forced_width_ = width;
  forced_height_ = height;
}
void EmulatedCamera::jam(bool jammed) {
  const std::lock_guard lock(mutex_);
  jammed_ = jammed;
}
int EmulatedCamera::turned(std::uint32_t id) {
  const std::lock_guard lock(mutex_);
  return turned_[id];
}
bool EmulatedCamera::streaming() {
  const std::lock_guard lock(mutex_);
  return streaming_;
}
int EmulatedCamera::control(std::uint32_t id) {
  const std::lock_guard lock(mutex_);
  const Control* control = findControl(id);
  return control != nullptr ? control->value : 0;
}
int EmulatedCamera::timesSet(std::uint32_t id) {
  const std::lock_guard lock(mutex_);
  return times_set_[id];
}
void EmulatedCamera::setControl(std::uint32_t id, int value) {
  const std::lock_guard lock(mutex_);
  if (Control* control = findControl(id)) control->value = value;
}
std::vector<std::uint8_t> EmulatedCamera::lastPicture() {
  const std::lock_guard lock(mutex_);
  return last_;
}

EmulatedCamera::Clock::time_point EmulatedCamera::lastGivenAt() {
  const std::lock_guard lock(mutex_);
  return last_given_at_;
}

IoctlAnswer EmulatedCamera::handle(unsigned code, const Argument& argument) {
  const std::lock_guard lock(mutex_);
  if (const auto failure = failures_.find(code); failure != failures_.end() && failure->second != 0) {
    return IoctlAnswer::failed(failure->second);
  }
  switch (code) {
    case VIDIOC_QUERYCAP:
    case VIDIOC_ENUM_FMT:
    case VIDIOC_ENUM_FRAMESIZES:
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return describe(code, argument);
    case VIDIOC_S_FMT:
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return configure(code, argument);
    case VIDIOC_REQBUFS:
    case VIDIOC_QUERYBUF:
    case VIDIOC_QBUF:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return stream(code, argument);
    case VIDIOC_DQBUF:
      return dequeue(argument);
    case VIDIOC_QUERYCTRL:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
    case VIDIOC_S_EXT_CTRLS:
      return controls(code, argument);
    case UVCIOC_CTRL_MAP:
      return mapExtension(argument);
    default:
      return IoctlAnswer::failed(ENOTTY);
  }
}

std::vector<EmulatedCamera::Mode> EmulatedCamera::modesOf(const std::string& fourcc) const {
  std::vector<Mode> modes;
  std::copy_if(description_.modes.begin(), description_.modes.end(), std::back_inserter(modes),
               [&](const Mode& mode) { return mode.fourcc == fourcc; });
  return modes;
}

IoctlAnswer EmulatedCamera::describe(unsigned code, const Argument& argument) {
  std::vector<std::string> formats;
  for (const Mode& mode : description_.modes) {
    if (std::find(formats.begin(), formats.end(), mode.fourcc) == formats.end()) {
      formats.push_back(mode.fourcc);
    }
  }
  const auto format = [&](std::uint32_t fourcc) {
    return std::find_if(formats.begin(), formats.end(), [&](const auto& f) { return codeOf(f) == fourcc; });
  };
  if (code == VIDIOC_QUERYCAP) {
    const IoctlMemory memory = argument(sizeof(v4l2_capability));
    auto& found = memory.as<v4l2_capability>();
    put(found.driver, "emulated");
    put(found.card, description_.card);
    put(found.bus_info, "platform:cam" + std::to_string(description_.number));
    found.device_caps =
        V4L2_CAP_STREAMING | (description_.captures ? V4L2_CAP_VIDEO_CAPTURE : V4L2_CAP_META_CAPTURE);
    // All nodes of the device together: one of them may capture.
    found.capabilities = V4L2_CAP_STREAMING | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_DEVICE_CAPS;
    memory.commit();
    return {};
  }
  if (code == VIDIOC_ENUM_FMT) {
    const IoctlMemory memory = argument(sizeof(v4l2_fmtdesc));
    auto& found = memory.as<v4l2_fmtdesc>();
    if (found.index >= formats.size()) return IoctlAnswer::failed(EINVAL);
    found.pixelformat = codeOf(formats[found.index]);
    memory.commit();
    return {};
  }
  if (code == VIDIOC_ENUM_FRAMESIZES) {
    const IoctlMemory memory = argument(sizeof(v4l2_frmsizeenum));
    auto& found = memory.as<v4l2_frmsizeenum>();
    const auto name = format(found.pixel_format);
    if (name == formats.end()) return IoctlAnswer::failed(EINVAL);
    const auto modes = modesOf(*name);
    if (found.index >= modes.size()) return IoctlAnswer::failed(EINVAL);
    const Mode& mode = modes[found.index];
    const auto width = static_cast<unsigned>(mode.width);
    const auto height = static_cast<unsigned>(mode.height);
    if (mode.in_steps) {
      found.type = V4L2_FRMSIZE_TYPE_STEPWISE;
      found.stepwise = {16, width, 16, 16, height, 16};
    } else {
      found.type = V4L2_FRMSIZE_TYPE_DISCRETE;
      found.discrete = {width, height};
    }
    memory.commit();
    return {};
  }
  const IoctlMemory memory = argument(sizeof(v4l2_frmivalenum));
  auto& found = memory.as<v4l2_frmivalenum>();
  const auto name = format(found.pixel_format);
  if (name == formats.end()) return IoctlAnswer::failed(EINVAL);
  for (const Mode& mode : modesOf(*name)) {
    if (!mode.in_steps &&
        (mode.width != static_cast<int>(found.width) || mode.height != static_cast<int>(found.height))) {
      continue;
    }
    if (found.index >= mode.rates_hz.size()) break;
    found.type = V4L2_FRMIVAL_TYPE_DISCRETE;
    found.discrete = {1, static_cast<unsigned>(mode.rates_hz[found.index])};
    memory.commit();
    return {};
  }
  return IoctlAnswer::failed(EINVAL);
}

IoctlAnswer EmulatedCamera::configure(unsigned code, const Argument& argument) {
  if (code == VIDIOC_S_FMT) {
    if (streaming_) return IoctlAnswer::failed(EBUSY);
    const IoctlMemory memory = argument(sizeof(v4l2_format));
    auto& pix = memory.as<v4l2_format>().fmt.pix;
    // As the kernel does it: whatever is asked becomes something that it can.
    const Mode* best = &description_.modes.front();
    for (const Mode& mode : description_.modes) {
      if (codeOf(mode.fourcc) != pix.pixelformat) continue;
      if (codeOf(best->fourcc) != pix.pixelformat) best = &mode;
      if (mode.in_steps ||
          (mode.width == static_cast<int>(pix.width) && mode.height == static_cast<int>(pix.height))) {
        best = &mode;
      }
    }
    current_ = *best;
    if (best->in_steps) {
      current_.width = static_cast<int>(pix.width) / 16 * 16;
      current_.height = static_cast<int>(pix.height) / 16 * 16;
    }
    if (forced_width_ > 0) {
      current_.width = forced_width_;
      current_.height = forced_height_;
    }
    current_.rates_hz.resize(1);
    pix.width = static_cast<unsigned>(current_.width);
    pix.height = static_cast<unsigned>(current_.height);
    pix.pixelformat = codeOf(current_.fourcc);
    pix.bytesperline = static_cast<unsigned>(bytesPerLine(current_.fourcc, current_.width));
    pix.sizeimage = kBufferBytes;
    memory.commit();
    return {};
  }
  const IoctlMemory memory = argument(sizeof(v4l2_streamparm));
  auto& capture = memory.as<v4l2_streamparm>().parm.capture;
  if (code == VIDIOC_S_PARM && capture.timeperframe.numerator > 0) {
    const double asked_hz =
        static_cast<double>(capture.timeperframe.denominator) / capture.timeperframe.numerator;
    for (const Mode& mode : description_.modes) {
      if (mode.fourcc != current_.fourcc || mode.width < current_.width) continue;
      current_.rates_hz = {*std::min_element(mode.rates_hz.begin(), mode.rates_hz.end(), [&](int a, int b) {
        return std::abs(a - asked_hz) < std::abs(b - asked_hz);
      })};
      break;
    }
  }
  capture.capability = V4L2_CAP_TIMEPERFRAME;
  capture.timeperframe = {1, static_cast<unsigned>(current_.rates_hz.front())};
  memory.commit();
  return {};
}

IoctlAnswer EmulatedCamera::stream(unsigned code, const Argument& argument) {
  if (code == VIDIOC_STREAMON || code == VIDIOC_STREAMOFF) {
    streaming_ = code == VIDIOC_STREAMON;
    began_ = Clock::now();
    given_ = 0;
    if (!streaming_) queued_.clear();
    return {};
  }
  if (code == VIDIOC_REQBUFS) {
    const IoctlMemory memory = argument(sizeof(v4l2_requestbuffers));
    auto& request = memory.as<v4l2_requestbuffers>();
    if (streaming_ && request.count > 0) return IoctlAnswer::failed(EBUSY);
    request.count = std::min(request.count, kMostBuffers);
    queued_.clear();
    memory.commit();
    return {};
  }
  const IoctlMemory memory = argument(sizeof(v4l2_buffer));
  auto& buffer = memory.as<v4l2_buffer>();
  if (buffer.index >= kMostBuffers) return IoctlAnswer::failed(EINVAL);
  if (code == VIDIOC_QUERYBUF) {
    buffer.length = kBufferBytes;
    buffer.m.offset = static_cast<unsigned>(buffer.index * kBufferBytes);
  } else {
    queued_.push_back(buffer.index);
  }
  memory.commit();
  return {};
}

IoctlAnswer EmulatedCamera::dequeue(const Argument& argument) {
  if (!streaming_) return IoctlAnswer::failed(EINVAL);
  const std::chrono::duration<double> since = Clock::now() - began_;
  const auto due = static_cast<std::int64_t>(since.count() * current_.rates_hz.front());
  if (hushed_ || queued_.empty() || due <= given_) return IoctlAnswer::failed(EAGAIN);
  given_ = due;
  const IoctlMemory memory = argument(sizeof(v4l2_buffer));
  auto& buffer = memory.as<v4l2_buffer>();
  buffer.index = queued_.front();
  queued_.erase(queued_.begin());
  buffer.sequence = static_cast<std::uint32_t>(due - 1);
  last_ = paintPicture(current_.fourcc, current_.width, current_.height,
                       static_cast<std::uint8_t>(shadeOf(buffer.sequence)), bare_jpeg_);
  if (std::exchange(shorten_, false)) last_.resize(last_.size() / 2);
  std::memcpy(memory_ + buffer.index * kBufferBytes, last_.data(), last_.size());
  buffer.bytesused = static_cast<unsigned>(last_.size());
  buffer.flags = unknown_clock_ ? V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN : V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  if (std::exchange(damage_, false)) buffer.flags |= V4L2_BUF_FLAG_ERROR;
  const auto at = std::chrono::duration_cast<std::chrono::microseconds>(
      (began_ + std::chrono::duration<double>(static_cast<double>(due) / current_.rates_hz.front()))
          .time_since_epoch());
  buffer.timestamp.tv_sec = at.count() / 1'000'000;
  buffer.timestamp.tv_usec = at.count() % 1'000'000;
  memory.commit();
  last_given_at_ = Clock::now();
  return {};
}

EmulatedCamera::Control* EmulatedCamera::findControl(std::uint32_t id) {
  const auto found = std::find_if(description_.controls.begin(), description_.controls.end(),
                                  [&](const Control& control) { return control.id == id; });
  return found == description_.controls.end() ? nullptr : &*found;
}

int EmulatedCamera::set(std::uint32_t id, int value) {
  Control* control = findControl(id);
  if (control == nullptr) return EINVAL;
  ++times_set_[id];
  if (jammed_) return 0;
  // The kernel rounds to the step and keeps to the limits.
  const int inside = std::clamp(value, control->minimum, control->maximum);
  control->value = control->minimum + (inside - control->minimum) / control->step * control->step;
  if (id == V4L2_CID_PAN_RELATIVE || id == V4L2_CID_TILT_RELATIVE) turned_[id] += control->value;
  if (id == V4L2_CID_PAN_RESET) turned_[V4L2_CID_PAN_RELATIVE] = 0;
  if (id == V4L2_CID_TILT_RESET) turned_[V4L2_CID_TILT_RELATIVE] = 0;
  return 0;
}

IoctlAnswer EmulatedCamera::mapExtension(const Argument& argument) {
  if (!description_.orbit) return IoctlAnswer::failed(ENOENT);
  const IoctlMemory memory = argument(sizeof(uvc_xu_control_mapping));
  const auto& mapping = memory.as<uvc_xu_control_mapping>();
  // 63610682-5070-49ab-b8cc-b3855e8d2256
  constexpr std::uint8_t kMotors[16] = {0x82, 0x06, 0x61, 0x63, 0x70, 0x50, 0xab, 0x49,
                                        0xb8, 0xcc, 0xb3, 0x85, 0x5e, 0x8d, 0x22, 0x56};
  if (std::memcmp(mapping.entity, kMotors, sizeof kMotors) != 0) return IoctlAnswer::failed(ENOENT);
  if (findControl(mapping.id) != nullptr) return IoctlAnswer::failed(EEXIST);
  Control control;
  control.id = mapping.id;
  control.title = reinterpret_cast<const char*>(mapping.name);
  control.type = static_cast<int>(mapping.v4l2_type);
  control.minimum = -32768;
  control.maximum = 32767;
  control.write_only = true;
  description_.controls.push_back(control);
  return {};
}

IoctlAnswer EmulatedCamera::controls(unsigned code, const Argument& argument) {
  if (code == VIDIOC_QUERYCTRL) {
    const IoctlMemory memory = argument(sizeof(v4l2_queryctrl));
    auto& found = memory.as<v4l2_queryctrl>();
    const std::uint32_t id = found.id & ~(V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND);
    const bool next = (found.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    const Control* best = nullptr;
    for (const Control& control : description_.controls) {
      if (next ? control.id > id && (best == nullptr || control.id < best->id) : control.id == id)
        best = &control;
    }
    if (best == nullptr) return IoctlAnswer::failed(EINVAL);
    found = {};
    found.id = best->id;
    found.type = static_cast<unsigned>(best->type);
    put(found.name, best->title);
    found.minimum = best->minimum;
    found.maximum = best->maximum;
    found.step = best->step;
    memory.commit();
    return {};
  }
  if (code == VIDIOC_S_EXT_CTRLS) {
    const IoctlMemory memory = argument(sizeof(v4l2_ext_controls));
    const auto& request = memory.as<v4l2_ext_controls>();
    const IoctlMemory list =
        memory.at(offsetof(v4l2_ext_controls, controls), request.count * sizeof(v4l2_ext_control));
    for (unsigned i = 0; i < request.count; ++i) {
      const auto& control = reinterpret_cast<const v4l2_ext_control*>(list.bytes())[i];
      if (const int error = set(control.id, control.value); error != 0) return IoctlAnswer::failed(error);
    }
    return {};
  }
  const IoctlMemory memory = argument(sizeof(v4l2_control));
  auto& control = memory.as<v4l2_control>();
  const Control* found = findControl(control.id);
  if (found == nullptr) return IoctlAnswer::failed(EINVAL);
  if (code == VIDIOC_S_CTRL) {
    const int error = set(control.id, control.value);
    return error == 0 ? IoctlAnswer{} : IoctlAnswer::failed(error);
  }
  if (found->write_only) return IoctlAnswer::failed(EACCES);
  control.value = found->value;
  memory.commit();
  return {};
}

}  // namespace vismem
