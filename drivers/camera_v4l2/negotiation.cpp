#include "drivers/camera_v4l2/negotiation.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>

namespace vismem::v4l2 {
namespace {

/// Above the number of entries of any camera; bounds the endless lists of a faulty device.
constexpr unsigned kMostEntries = 256;

Mode withRates(const V4l2Device& device, Mode mode) {
  for (unsigned i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum found{};
    found.index = i;
    found.pixel_format = mode.format.fourcc;
    found.width = static_cast<unsigned>(mode.width);
    found.height = static_cast<unsigned>(mode.height);
    if (device.request(VIDIOC_ENUM_FRAMEINTERVALS, &found) != 0) break;
    if (found.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      if (found.discrete.numerator > 0 && found.discrete.denominator > 0) {
        mode.rates.push_back({found.discrete.numerator, found.discrete.denominator});
      }
      continue;
    }
    const auto& range = found.stepwise;
    if (range.min.numerator > 0 && range.max.numerator > 0) {
      mode.fastest = Interval{range.min.numerator, range.min.denominator};
      mode.slowest = Interval{range.max.numerator, range.max.denominator};
    }
    break;
  }
  return mode;
}

void addSizes(const V4l2Device& device, const PixelFormat& format, const FrameRequest& request,
              std::vector<Mode>& modes) {
  for (unsigned i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum found{};
    found.index = i;
    found.pixel_format = format.fourcc;
    if (device.request(VIDIOC_ENUM_FRAMESIZES, &found) != 0) return;
    Mode mode;
    mode.format = format;
    if (found.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      mode.width = static_cast<int>(found.discrete.width);
      mode.height = static_cast<int>(found.discrete.height);
    } else {
      const auto& s = found.stepwise;
      const bool open = request.width == 0 && request.height == 0;
      int width = open ? kUsualWidth_px : request.width;
      int height = open ? kUsualHeight_px : request.height;
      if (width == 0) width = height * 4 / 3;
      if (height == 0) height = width * 3 / 4;
      mode.width = nearestInSteps(width, static_cast<int>(s.min_width), static_cast<int>(s.max_width),
                                  static_cast<int>(s.step_width));
      mode.height = nearestInSteps(height, static_cast<int>(s.min_height), static_cast<int>(s.max_height),
                                   static_cast<int>(s.step_height));
    }
    if (mode.width > 0 && mode.height > 0 && std::max(mode.width, mode.height) <= kMaxImageSide_px) {
      modes.push_back(withRates(device, mode));
    }
    if (found.type != V4L2_FRMSIZE_TYPE_DISCRETE) return;
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// @return the resulting rate [Hz]; 0 if the camera does not report it.
double setRate(const V4l2Device& device, const Interval& interval) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device.request(VIDIOC_G_PARM, &parameters) != 0) return 0.0;
  auto& time = parameters.parm.capture.timeperframe;
  if (interval.numerator > 0 && (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
    time = {interval.numerator, interval.denominator};
    if (device.request(VIDIOC_S_PARM, &parameters) != 0) return 0.0;
  }
  return Interval{time.numerator, time.denominator}.rate_hz();
}

}  // namespace

std::vector<Mode> offeredModes(const V4l2Device& device, const FrameRequest& request,
                               std::vector<std::string>& others) {
  std::vector<Mode> modes;
  for (unsigned i = 0; i < kMostEntries; ++i) {
    v4l2_fmtdesc found{};
    found.index = i;
    found.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (device.request(VIDIOC_ENUM_FMT, &found) != 0) break;
    if (const PixelFormat* format = formatOf(found.pixelformat)) {
      addSizes(device, *format, request, modes);
    } else {
      others.push_back(fourccText(found.pixelformat));
    }
  }
  return modes;
}

Agreement negotiate(const V4l2Device& device, const FrameRequest& request, const PixelFormat* format) {
  Agreement agreement;
  std::vector<std::string> others;
  std::vector<Mode> modes = offeredModes(device, request, others);
  if (!device.isThere()) {
    agreement.away = device.failed("was unplugged");
    return agreement;
  }
  std::vector<std::string> names = others;
  for (const Mode& mode : modes) {
    if (std::find(names.begin(), names.end(), mode.format.name) == names.end()) {
      names.emplace_back(mode.format.name);
    }
  }
  if (format != nullptr) {
    std::erase_if(modes, [&](const Mode& mode) { return mode.format.fourcc != format->fourcc; });
  }
  if (modes.empty()) {
    agreement.reply = PortReply::rejected(device.failed(
        std::string("offers no ") + (format != nullptr ? format->name : "format that is read here") +
        " (it has: " + listed(names) + ")"));
    return agreement;
  }
  const Choice choice = chooseMode(modes, request);
  v4l2_format set{};
  set.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  set.fmt.pix.pixelformat = choice.mode.format.fourcc;
  set.fmt.pix.width = static_cast<unsigned>(choice.mode.width);
  set.fmt.pix.height = static_cast<unsigned>(choice.mode.height);
  set.fmt.pix.field = V4L2_FIELD_ANY;
  if (const int error = device.request(VIDIOC_S_FMT, &set); error != 0) {
    agreement.away = device.failed("no format can be set", error);
    return agreement;
  }
  const PixelFormat* became = formatOf(set.fmt.pix.pixelformat);
  if (became == nullptr || set.fmt.pix.width < 1 || set.fmt.pix.height < 1 ||
      std::max(set.fmt.pix.width, set.fmt.pix.height) > kMaxImageSide_px) {
    agreement.away =
        device.failed("changed " + std::string(choice.mode.format.name) + " to " +
                      fourccText(set.fmt.pix.pixelformat) + " of " + std::to_string(set.fmt.pix.width) + "x" +
                      std::to_string(set.fmt.pix.height) + ", which is not read here");
    return agreement;
  }
  agreement.layout = {*became, static_cast<int>(set.fmt.pix.width), static_cast<int>(set.fmt.pix.height),
                      static_cast<int>(set.fmt.pix.bytesperline)};
  agreement.rate_hz = setRate(device, choice.interval);
  agreement.reply = replyTo(request, agreement.layout.width, agreement.layout.height, agreement.rate_hz);
  return agreement;
}

}  // namespace vismem::v4l2
