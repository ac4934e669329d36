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
    camera.describe(basic("Proxy", "one camera; any number of them"));
    stream.proxy = camera.requiredText("Proxy", "the proxy of an avm::Camera, such as cameraA:tcp -p 9999");
    camera.describe(expert("Topic", "topics TOPIC/image_raw, TOPIC/camera_info"));
    stream.topic = camera.text("Topic", defaultTopic(name, names.size()));
    camera.describe(basic("Images", "as the camera gives them, as pixels, or as PNG"));
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
    ConfigReader component = reader.group("Components." + name);
    component.describe(basic("Proxy", "whose state and configuration are kept"));
    config.components.push_back(component.requiredText("Proxy", "the proxy of an avm::Component"));
  }
}

void readRing(ConfigReader& reader, RecorderConfig& config) {
  reader.describe(basic("Ring.Length_s", "the last seconds of everything stay in memory; 0: none"));
  config.core.ring_us = toStampUs(reader.real("Ring.Length_s", 0.0, 0.0, 3600.0));
  reader.describe(expert("Ring.Memory_MB", "what they may take"));
  config.core.ring_bytes = megabytes(reader, "Ring.Memory_MB", 256.0, 1.0, 65536.0);
  reader.describe(expert("Ring.SaveWhenLost", "save them when localization is lost"));
  config.ring_on_loss = reader.boolean("Ring.SaveWhenLost", true);
  reader.describe(expert("Ring.After_s", "save them so long after the loss"));
  config.ring_after_s = reader.real("Ring.After_s", 2.0, 0.0, 600.0);
  reader.describe(expert("Ring.LostBelow", "lost: the reliability falls below this"));
  config.loss_lost = reader.real("Ring.LostBelow", 0.3, 0.0, 1.0);
  reader.describe(expert("Ring.SureAbove", "after it was above this"));
  config.loss_sure = reader.real("Ring.SureAbove", 0.6, 0.0, 1.0);
  if (config.loss_lost >= config.loss_sure) {
    reader.problem("Ring.LostBelow", "must be less than " + reader.key("Ring.SureAbove"));
  }
}

}  // namespace

RecorderConfig readRecorderConfig(ConfigReader& reader) {
  RecorderConfig config;
  reader.describe(basic("Folder", "where recordings go, each a folder of its own"));
  config.folder = reader.outputPath("Folder", "out/recordings");
  reader.describe(basic("StartNow", "record from the start, or wait for avm::Recorder::start"));
  config.start_now = reader.boolean("StartNow", true);
  reader.describe(expert("Name", "of that recording; empty: by date and time"));
  config.name = reader.text("Name", "");
  if (!config.name.empty()) {
    if (const auto wrong = checkFileName(config.name); !wrong.empty()) reader.problem("Name", wrong);
  }
  reader.describe(expert("Sync", "each chunk waits for the disk, so that it survives a power failure"));
  config.durable = reader.boolean("Sync", true);
  reader.describe(
      basic("Memory_MB", "what may wait for a slow disk; what does not fit is dropped and counted"));
  config.queue_bytes = megabytes(reader, "Memory_MB", 64.0, 1.0, 65536.0);
  BagRecordingParams& bag = config.core.bag;
  reader.describe(basic("Compression", "of the chunks"));
  bag.compression = reader.choice("Compression", BagCompression::kNone,
                                  {{"none", BagCompression::kNone}, {"lz4", BagCompression::kLz4}});
  reader.describe(expert("Chunk.Length_s", "written in one piece; as much may be lost in a power failure"));
  bag.max_chunk_us = toStampUs(reader.real("Chunk.Length_s", 0.5, 0.01, 1.0));
  reader.describe(expert("Chunk.Size_MB", "the same by size"));
  bag.max_chunk_bytes = megabytes(reader, "Chunk.Size_MB", 1.0, 0.01, 64.0);
  reader.describe(basic("Split.Size_MB", "a part ends at this size; 0: never"));
  bag.split_bytes = megabytes(reader, "Split.Size_MB", 0.0, 0.0, 1e7);
  reader.describe(expert("Split.Length_s", "a part ends at this length; 0: never"));
  bag.split_us = toStampUs(reader.real("Split.Length_s", 0.0, 0.0, 1e6));
  readRing(reader, config);
  readCameras(reader, config);
  const auto proxy = [&reader](const char* name, const char* meaning) {
    return reader.describe(basic(name, meaning)).text(name, "");
  };
  config.odometry = proxy("Odometry.Proxy", "an avm::Odometry; empty: not recorded");
  config.pan_tilt = proxy("PanTilt.Proxy", "an avm::PanTilt; empty: not recorded");
  config.memory = proxy("VisualMemory.Proxy", "an avm::VisualMemory; empty: not recorded");
  config.gaze = proxy("Gaze.Proxy", "an avm::Gaze; empty: not recorded");
  config.localization = proxy("Localization.Proxy", "an avm::Localization; empty: not recorded");
  config.simulation = proxy("Simulation.Proxy", "an avm::Simulation, for the truth; empty: not recorded");
  readComponents(reader, config);
  reader.describe(expert("StatusPeriod_s", "between two states of a component"));
  config.status_period_s = reader.real("StatusPeriod_s", 1.0, 0.05, 60.0);
  reader.describe(basic("Map", "shown as markers, and copied with its palette beside the bags"));
  config.map = reader.existingFile("Map", "a map, such as cfg/maps/corridor.csv");
  return config;
}

}  // namespace vismem
