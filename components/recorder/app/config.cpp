#include "recorder/app/config.h"

#include <algorithm>
#include <limits>

#include "common/config/file_name.h"

namespace vismem {
namespace {

constexpr double kMiB = 1 << 20;

std::size_t megabytes(ConfigReader& reader, const char* name, double fallback, double minimum,
                      double maximum) {
  return static_cast<std::size_t>(reader.real(name, fallback, minimum, maximum) * kMiB);
}

/// "cameraA": "/camera" for the only one, as other people's bags have it, else "/cameraA".
std::string defaultTopic(const std::string& name, std::size_t cameras) {
  return cameras == 1 ? "/camera" : "/" + name;
}

std::string checkTopic(const std::string& topic) {
  const bool plain = std::all_of(topic.begin(), topic.end(), [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' || c == '_';
  });
  const bool good = topic.size() > 1 && topic.front() == '/' && topic.back() != '/' && plain;
  return good ? "" : "must begin with '/' and have letters, digits, '_' and '/' only";
}

void readCameras(ConfigReader& reader, RecorderConfig& config) {
  const auto names = reader.children("Cameras");
  for (const std::string& name : names) {
    ConfigReader camera = reader.group("Cameras." + name);
    RecorderConfig::CameraStream stream;
    stream.name = name;
    stream.proxy = camera.requiredText("Proxy", "the proxy of an avm::Camera, such as cameraA:tcp -p 9999");
    stream.topic = camera.text("Topic", defaultTopic(name, names.size()));
    stream.storage = camera.choice(
        "Images", ImageStorage::kCaptured,
        {{"captured", ImageStorage::kCaptured}, {"raw", ImageStorage::kRaw}, {"png", ImageStorage::kPng}});
    if (const auto wrong = checkTopic(stream.topic); !wrong.empty()) camera.problem("Topic", wrong);
    for (const auto& other : config.cameras) {
      if (other.topic == stream.topic)
        camera.problem("Topic", "is that of camera " + other.name + " already");
    }
    config.cameras.push_back(std::move(stream));
  }
}

/// Keys of the proxies that are separated by blanks cannot hold proxies: one key a component.
void readComponents(ConfigReader& reader, RecorderConfig& config) {
  for (const std::string& name : reader.children("Components")) {
    config.components.push_back(
        reader.group("Components." + name).requiredText("Proxy", "the proxy of an avm::Component"));
  }
}

void readRing(ConfigReader& reader, RecorderConfig& config) {
  config.core.ring_us = toStampUs(reader.real("Ring.Length_s", 0.0, 0.0, 3600.0));
  config.core.ring_bytes = megabytes(reader, "Ring.Memory_MB", 256.0, 1.0, 65536.0);
  config.ring_on_loss = reader.boolean("Ring.SaveWhenLost", true);
  config.ring_after_s = reader.real("Ring.After_s", 2.0, 0.0, 600.0);
  config.loss_lost = reader.real("Ring.LostBelow", 0.3, 0.0, 1.0);
  config.loss_sure = reader.real("Ring.SureAbove", 0.6, 0.0, 1.0);
  if (config.loss_lost >= config.loss_sure) {
    reader.problem("Ring.LostBelow", "must be less than " + reader.key("Ring.SureAbove"));
  }
}

}  // namespace

RecorderConfig readRecorderConfig(ConfigReader& reader) {
  RecorderConfig config;
  config.folder = reader.outputPath("Folder", "out/recordings");
  config.start_now = reader.boolean("StartNow", true);
  config.name = reader.text("Name", "");
  if (!config.name.empty()) {
    if (const auto wrong = checkFileName(config.name); !wrong.empty()) reader.problem("Name", wrong);
  }
  config.durable = reader.boolean("Sync", true);
  config.queue_bytes = megabytes(reader, "Memory_MB", 64.0, 1.0, 65536.0);
  BagRecordingParams& bag = config.core.bag;
  bag.compression = reader.choice("Compression", BagCompression::kNone,
                                  {{"none", BagCompression::kNone}, {"lz4", BagCompression::kLz4}});
  bag.max_chunk_us = toStampUs(reader.real("Chunk.Length_s", 0.5, 0.01, 1.0));
  bag.max_chunk_bytes = megabytes(reader, "Chunk.Size_MB", 1.0, 0.01, 64.0);
  bag.split_bytes = megabytes(reader, "Split.Size_MB", 0.0, 0.0, 1e7);
  bag.split_us = toStampUs(reader.real("Split.Length_s", 0.0, 0.0, 1e6));
  readRing(reader, config);
  readCameras(reader, config);
  config.odometry = reader.text("Odometry.Proxy", "");
  config.pan_tilt = reader.text("PanTilt.Proxy", "");
  config.memory = reader.text("VisualMemory.Proxy", "");
  config.gaze = reader.text("Gaze.Proxy", "");
  config.localization = reader.text("Localization.Proxy", "");
  config.simulation = reader.text("Simulation.Proxy", "");
  readComponents(reader, config);
  config.status_period_s = reader.real("StatusPeriod_s", 1.0, 0.05, 60.0);
  config.map = reader.existingFile("Map", "a map, such as cfg/maps/corridor.csv");
  return config;
}

}  // namespace vismem
