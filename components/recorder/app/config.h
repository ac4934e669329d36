/// @file Configuration of recorder: every key, checked once at start.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/config_reader.h"
#include "recorder/core/recorder_core.h"
#include "recorder/ice/sensor_messages.h"

namespace vismem {

/// See C1. All keys begin with "Recorder."; the table is in the component's README.
struct RecorderConfig {
  struct CameraStream {
    std::string name;  ///< "cameraA"
    std::string proxy;
    std::string topic;  ///< "/camera"
    ImageStorage storage = ImageStorage::kCaptured;
  };

  std::filesystem::path folder;
  bool start_now = true;
  std::string name;  ///< of the recording that starts with the process; empty: by date and time
  bool durable = true;
  std::size_t queue_bytes = 0;
  RecorderParams core;
  double ring_after_s = 0.0;
  bool ring_on_loss = false;
  double loss_lost = 0.0;
  double loss_sure = 0.0;

  std::vector<CameraStream> cameras;
  // Proxies; empty: not recorded.
  std::string odometry;
  std::string pan_tilt;
  std::string memory;
  std::string gaze;
  std::string localization;
  std::string simulation;
  std::vector<std::string> components;
  double status_period_s = 1.0;
  std::filesystem::path map;  ///< shown as markers, and copied beside the bags with its palette
};

/// @param reader at the prefix "Recorder". Problems are collected in it; the caller finishes it.
RecorderConfig readRecorderConfig(ConfigReader& reader);

}  // namespace vismem
