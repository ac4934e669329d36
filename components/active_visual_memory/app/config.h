/// @file Configuration of active_visual_memory: every key, checked once at start. Pure but for looking files
/// up. See C2.
#pragma once

#include <filesystem>
#include <string>

#include "active_visual_memory/core/memory_pipeline.h"
#include "common/config/config_reader.h"
#include "common/kinematics/calibrated_ports.h"
#include "common/robot/observation.h"

namespace vismem {

/// See C2. All keys begin with "ActiveVisualMemory."; the table is in the component's README.
struct ActiveVisualMemoryConfig {
  std::string camera_proxy;
  std::string odometry_proxy;
  std::string
      pan_tilt_proxy;  ///< empty: no pan-tilt unit; frames carry the camera's pose and the gaze is off
  std::filesystem::path palette;  ///< empty: labels stay unknown
  bool every_frame = false;       ///< false: the newest frame wins
  double images_lost_s = 0.5;     ///< without a frame for this long the head holds still
  bool overlay = true;            ///< serve memoryView
  double overlay_rate_hz = 10.0;  ///< at most, of the images' own time
  ObservationAssembler::Params assembler;
  MemoryPipelineParams pipeline;
  JointCorrection joints;        ///< keys that `calibrate body` writes
  WheelCorrectionParams wheels;  ///< the same
  /// Standard deviation of the calibrated camera tilt [rad]; 0: the mounting was not calibrated.
  double calibrated_tilt_rad = 0.0;

  bool hasPanTilt() const { return !pan_tilt_proxy.empty(); }
};

/// Reads and checks every key of the component. Problems are collected in `reader`; the caller finishes it.
ActiveVisualMemoryConfig readActiveVisualMemoryConfig(ConfigReader& reader);

/// The part that lock-step tools share: mode, mount, vision, memory, gaze. Keys as above.
/// @param reader at the prefix "ActiveVisualMemory".
MemoryPipelineParams readMemoryPipeline(ConfigReader& reader);
CameraMount readCameraMount(ConfigReader& reader);

}  // namespace vismem
