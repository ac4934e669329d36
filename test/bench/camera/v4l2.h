/// @file Load of camera_server with a V4L2 camera, emulated by umockdev.
#pragma once

namespace vismem {

/// To be run behind umockdev-wrapper: starts camera_server with an emulated camera, measures, prints tables
/// and one line of JSON.
/// @param seconds of each run.
/// @return the exit code.
int benchV4l2(double seconds);

}  // namespace vismem
