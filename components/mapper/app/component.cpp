#include "mapper/app/component.h"

#include <memory>
#include <utility>

#include "common/memory_ice/visual_memory_ice.h"
#include "common/process/peer.h"
#include "common/process/status.h"
#include "common/robot_ice/camera_ice.h"
#include "evaluation/core/trajectory_io.h"
#include "mapper/app/config.h"
#include "mapper/app/map_builder.h"
#include "mapper/app/mapping_loop.h"
#include "mapper/core/drive_record_io.h"
#include "mapper/ice/mapper_ice.h"

namespace vismem {
namespace {

class MapperComponent final : public Component, public MapperControl {
 public:
  explicit MapperComponent(MapperConfig config) : config_(std::move(config)) {}

  void start(ComponentHost& host) override {
    auto& communicator = *host.communicator();
    const auto memory = communicator.stringToProxy(config_.visual_memory_proxy);
    const auto camera = communicator.stringToProxy(config_.camera_proxy);
    memory_ =
        std::make_unique<VisualMemoryClient>(Ice::uncheckedCast<avm::VisualMemoryPrx>(memory),
                                             reportTo("VisualMemory", memory, host.status(), host.log()));
    camera_ =
        std::make_unique<RemoteFrameSource>(Ice::uncheckedCast<avm::CameraPrx>(camera), FrameFormat::kRgb8,
                                            reportTo("Camera", camera, host.status(), host.log()));
    builder_ = std::make_unique<MapBuilder>([&host](const BuiltMap& map) { announce(map, host.status()); });
    loop_ = std::make_unique<MappingLoop>(config_.loop, *memory_, *camera_, host.status());
    host.serve("Mapper", std::make_shared<MapperServant>(*this));
    loop_->start([this, &host](const DriveProgress& now) { watch(now, host); },
                 [&host](std::exception_ptr failure) { host.fail(std::move(failure)); });
  }

  void stop() override {
    if (builder_) builder_->stop();
    if (!loop_) return;
    loop_->stop();
    saveDrive();
  }

  avm::MapperStatus status() const override { return toIce(loop_->progress(), builder_->status()); }

  PortReply build(const std::string& name) override {
    RecordedDrive drive = config_.blank;
    {
      const DriveCollector now = loop_->drive();
      drive.record = now.record();
      drive.updates = now.updates();
      drive.broken = now.isBroken();
    }
    if (drive.record.keyframes.empty())
      return PortReply::rejected("nothing is recorded yet: " + loop_->progress().message);
    MapFilesOptions files = config_.files;
    if (!name.empty()) files.name = name;
    return builder_->build(std::move(drive), std::move(files));
  }

  PortReply restart() override {
    loop_->restart();
    return PortReply::accepted();
  }

 private:
  static void announce(const BuiltMap& map, StatusBoard& status) {
    for (const std::string& problem : map.problems) status.error("map: " + problem);
    for (const std::string& note : map.notes) status.note("map: " + note);
    if (!map.file.empty()) {
      status.note("a map of " + std::to_string(map.edges) + " edges: " + map.file.string());
      status.latency("map", map.seconds);
    }
    status.gauge({"edges of the last map", static_cast<double>(map.edges), 0.0, ""});
    status.gauge({"edges seen again", static_cast<double>(map.seen_again), 0.0, ""});
  }

  /// In the loop's thread.
  void watch(const DriveProgress& now, ComponentHost& host) {
    const MapBuilderStatus builder = builder_->status();
    host.status().gauge({"keyframes", static_cast<double>(now.keyframes), 0.0, ""});
    host.status().gauge({"way", now.way_m, 0.0, "m"});
    host.status().gauge({"map in the making", builder.building ? 100.0 * builder.progress : 0.0, 0.0, "%"});
    if (now.message.empty() || now.finished) {
      host.status().healthy("drive");
    } else if (now.keyframes > 0) {
      host.status().fault("drive", now.message);
    }
    // A recording that is replayed ends: so does the drive.
    if (now.finished && now.keyframes > 0 && now.end_us != mapped_us_ && build("").ok())
      mapped_us_ = now.end_us;
  }

  /// What was driven since the last map is not lost: map_from_drive --drive makes a map of it.
  void saveDrive() {
    const DriveProgress now = loop_->progress();
    if (now.keyframes == 0 || now.end_us == mapped_us_ || builder_->status().last.way_m == now.way_m) return;
    std::filesystem::create_directories(config_.files.out);
    writeTextFile(config_.files.out / (config_.files.name + "_last.drive"),
                  writeDriveRecord({loop_->drive().record(), {}}));
  }

  const MapperConfig config_;
  std::unique_ptr<VisualMemoryClient> memory_;
  std::unique_ptr<RemoteFrameSource> camera_;
  std::unique_ptr<MapBuilder> builder_;
  StampUs mapped_us_ = -1;             ///< end of the drive that ended by itself; the loop's thread
  std::unique_ptr<MappingLoop> loop_;  ///< last member: its threads use all of the above
};

std::unique_ptr<Component> configure(ConfigReader& root) {
  ConfigReader reader = root.group("Mapper");
  MapperConfig config = readMapperConfig(reader);
  if (!reader.good()) return nullptr;
  return std::make_unique<MapperComponent>(std::move(config));
}

}  // namespace

ComponentSpec mapperSpec() {
  ComponentSpec spec;
  spec.name = "mapper";
  spec.prefix = "Mapper";
  spec.summary = "Makes a map of the place from the drive that is under way.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9974";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11009";
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
