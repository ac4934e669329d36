#include "recorder/app/recorder_component.h"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "common/config/config_error.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "recorder/app/config.h"
#include "recorder/app/file_store.h"
#include "recorder/app/map_markers.h"
#include "recorder/app/recorder_servant.h"
#include "recorder/app/recorder_service.h"
#include "recorder/app/session_folder.h"
#include "recorder/app/streams.h"

namespace vismem {
namespace {

RecorderService::Params serviceParams(const RecorderConfig& config) {
  RecorderService::Params params;
  params.core = config.core;
  params.folder = config.folder;
  params.queue_bytes = config.queue_bytes;
  if (config.ring_on_loss && config.core.ring_us > 0)
    params.save_after_loss_us = toStampUs(config.ring_after_s);
  params.loss_lost = config.loss_lost;
  params.loss_sure = config.loss_sure;
  return params;
}

class RecorderComponent : public Component {
 public:
  RecorderComponent(RecorderConfig config, std::optional<SegmentMap> map)
      : config_(std::move(config)),
        map_(std::move(map)),
        session_(config_.map, VISMEM_VERSION),
        store_(config_.folder, config_.durable, [this](const auto& folder) { session_.open(folder); }),
        service_(serviceParams(config_), store_),
        streams_(config_, service_, session_) {}

  void start(ComponentHost& host) override {
    std::error_code error;
    std::filesystem::create_directories(config_.folder, error);
    if (error) {
      throw std::runtime_error("Recorder.Folder = " + config_.folder.string() +
                               " (cannot be made: " + error.message() + ")");
    }
    service_.start([this, &host](const RecorderService::Status& now) { watch(host, now); },
                   [&host](const std::string& text) { host.status().note(text); });
    if (map_) service_.take(mapMarkers(*map_));
    host.serve("Recorder", std::make_shared<RecorderServant>(service_));
    if (config_.start_now) {
      const std::string name = config_.name.empty() ? service_.unusedName() : config_.name;
      service_.execute([name](RecorderCore& core) { return core.start(name); },
                       [&host](const PortReply& reply) {
                         if (reply.ok()) {
                           host.status().note("recording: " + reply.message);
                         } else {
                           host.fail(std::make_exception_ptr(std::runtime_error(reply.message)));
                         }
                       });
    }
    streams_.start(host);
  }

  void stop() override {
    streams_.stop();
    service_.stop();
  }

 private:
  /// On the writer's thread.
  void watch(ComponentHost& host, const RecorderService::Status& now) {
    StatusBoard& status = host.status();
    status.alive("writer");
    status.gauge({"waiting for the disk", static_cast<double>(now.queue_bytes) / (1 << 20), 0.0, "MB"});
    status.gauge({"recorded", static_cast<double>(now.report.bytes) / (1 << 20), 0.0, "MB"});
    status.gauge({"messages dropped", static_cast<double>(now.dropped), 0.0, "messages"});
    if (now.dropped > dropped_) {
      status.fault("disk",
                   "it is too slow: " + std::to_string(now.dropped) + " messages were dropped so far");
    } else if (now.queue_bytes < now.queue_limit_bytes / 2) {
      status.healthy("disk");
    }
    dropped_ = now.dropped;
    if (now.report.state == RecorderReport::State::kFailed) {
      status.fault("recording", now.report.message);
    } else {
      status.healthy("recording");
    }
  }

  const RecorderConfig config_;
  const std::optional<SegmentMap> map_;
  SessionFolder session_;
  FileStore store_;
  RecorderService service_;
  Streams streams_;
  std::uint64_t dropped_ = 0;  ///< of the writer's thread
};

std::unique_ptr<Component> configure(ConfigReader& config) {
  ConfigReader reader = config.group("Recorder");
  RecorderConfig settings = readRecorderConfig(reader);
  if (!reader.good()) return nullptr;
  std::optional<SegmentMap> map;
  if (!settings.map.empty()) map = loadSegmentMap(settings.map);
  return std::make_unique<RecorderComponent>(std::move(settings), std::move(map));
}

}  // namespace

ComponentSpec recorderSpec() {
  ComponentSpec spec;
  spec.name = "recorder";
  spec.prefix = "Recorder";
  spec.summary = "Records everything that the components publish.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9992";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11008";
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
