/// @file Configuration of camera_server: every key, checked once at start.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "camera_server/core/prepared_camera.h"
#include "common/config/config_reader.h"
#include "common/drivers/driver_registry.h"

namespace vismem {

struct ServedCamera {
  std::string identity;  ///< "cameraA"
  FrameRequest request;
  int jpeg_quality = 85;
  std::unique_ptr<PreparedCamera> camera;  ///< null only when the reader is not good()
};

/// See C1. All keys are under Camera.IDENTITY; the table is in the component's README. Opens no device.
/// @param reader at the prefix "CameraServer". It collects the problems; the caller finishes it.
/// @throw ConfigError for a calibration file that cannot be used.
std::vector<ServedCamera> readCameraServerConfig(ConfigReader& reader,
                                                 const DriverRegistry<FrameSource>& drivers);

}  // namespace vismem
