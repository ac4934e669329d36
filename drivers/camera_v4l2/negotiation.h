/// @file Negotiation of format, size and rate with a camera.
#pragma once

#include <string>
#include <vector>

#include "common/robot/ports.h"
#include "common/v4l2/v4l2_device.h"
#include "drivers/camera_v4l2/pixel_format.h"
#include "drivers/camera_v4l2/stream_mode.h"

namespace vismem::v4l2 {

struct Agreement {
  /// Rejected: the camera does not support the request. Otherwise accepted or adjusted, unless `away`.
  PortReply reply;
  /// Reason of a temporary failure; then nothing else is set.
  std::string away;
  PictureLayout layout;
  double rate_hz = 0.0;  ///< 0: not reported by the camera
};

/// Sets the open device to the mode nearest to the request, and reads the result back.
/// @param format the only accepted format; nullptr: the best one.
Agreement negotiate(const V4l2Device& device, const FrameRequest& request, const PixelFormat* format);

/// The modes of the device in supported formats; sizes in steps appear once, as near to the request as they
/// come.
/// @param others gets the names of formats that we do not read.
std::vector<Mode> offeredModes(const V4l2Device& device, const FrameRequest& request,
                               std::vector<std::string>& others);

}  // namespace vismem::v4l2
