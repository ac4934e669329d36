/// @file What a camera of V4L2 costs camera_server, with a camera on umockdev.
#pragma once

namespace vismem {

/// To be run behind umockdev-wrapper: starts camera_server with an emulated camera, measures, prints tables
/// and one line of JSON.
/// @param seconds of each run. @return the exit code.
int benchV4l2(double seconds);

}  // namespace vismem
