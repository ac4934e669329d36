/// @file Agrees with a camera on format, size and rate.
#pragma once

#include <string>
#include <vector>

#include "common/robot/ports.h"
#include "common/v4l2/v4l2_device.h"
#include "drivers/camera_v4l2/pixel_format.h"
#include "drivers/camera_v4l2/stream_mode.h"

namespace vismem::v4l2 {

struct Agreement {
  /// Rejected: the camera can never give what is asked. Otherwise accepted or adjusted, unless `away`.
  PortReply reply;
  /// Why nothing could be agreed on now, but may be later; then nothing else is set.
  std::string away;
  PictureLayout layout;
  double rate_hz = 0.0;  ///< 0: the camera does not tell
};

/// Sets the open device to the mode that comes nearest to the request, and reads back what became of it.
/// @param format the only one to be taken; nullptr: whichever does best.
Agreement negotiate(const V4l2Device& device, const FrameRequest& request, const PixelFormat* format);

/// What the device offers of the formats that we read; sizes in steps appear once, as near to the request as
/// they come. @param others gets the names of formats that we do not read.
std::vector<Mode> offeredModes(const V4l2Device& device, const FrameRequest& request,
                               std::vector<std::string>& others);

}  // namespace vismem::v4l2
