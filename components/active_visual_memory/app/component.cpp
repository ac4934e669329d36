#include "active_visual_memory/app/component.h"

#include <atomic>
#include <optional>
#include <utility>

#include "active_visual_memory/app/memory_parameters.h"
#include "active_visual_memory/app/perception_loop.h"
#include "common/memory_ice/gaze_ice.h"
#include "common/memory_ice/visual_memory_ice.h"
#include "common/process/peer.h"
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/camera_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "common/visual_memory/overlay.h"

namespace vismem {
namespace {

class ActiveVisualMemory final : public Component {
 public:
  ActiveVisualMemory(ActiveVisualMemoryConfig config, std::shared_ptr<const Palette> palette)
      : config_(std::move(config)),
        palette_(std::move(palette)),
        gaze_(config_.hasPanTilt()),
        overlay_rate_hz_(config_.overlay_rate_hz) {}

  void start(ComponentHost& host) override {
    auto& communicator = *host.communicator();
    const auto camera = communicator.stringToProxy(config_.camera_proxy);
    const auto odometry = communicator.stringToProxy(config_.odometry_proxy);
    camera_ =
        std::make_unique<RemoteFrameSource>(Ice::uncheckedCast<avm::CameraPrx>(camera), FrameFormat::kRgb8,
                                            reportTo("Camera", camera, host.status(), host.log()));
    base_ = std::make_unique<RemoteMobileBase>(nullptr, Ice::uncheckedCast<avm::OdometryPrx>(odometry),
                                               reportTo("Odometry", odometry, host.status(), host.log()));
    if (config_.hasPanTilt()) {
      const auto unit = communicator.stringToProxy(config_.pan_tilt_proxy);
      pan_tilt_ = std::make_unique<RemotePanTiltUnit>(Ice::uncheckedCast<avm::PanTiltPrx>(unit),
                                                      reportTo("PanTilt", unit, host.status(), host.log()));
    }
    calibrated_base_ = std::make_unique<CalibratedBase>(*base_, config_.wheels);
    if (pan_tilt_) calibrated_pan_tilt_ = std::make_unique<CalibratedPanTilt>(*pan_tilt_, config_.joints);
    loop_ = std::make_unique<PerceptionLoop>(
        PerceptionLoop::Params{config_.assembler, config_.pipeline, config_.every_frame,
                               config_.images_lost_s, config_.calibrated_tilt_rad},
        palette_, *camera_, calibrated_pan_tilt_.get(), *calibrated_base_, gaze_, host.status());

    host.serve("VisualMemory", std::make_shared<VisualMemoryServant>(memory_, [this] {
                 loop_->reset();
                 return PortReply::accepted();
               }));
    host.serve("Gaze", std::make_shared<GazeServant>(gaze_, gaze_statuses_));
    listMemoryParameters(host.parameters(), config_, *loop_, overlay_rate_hz_);
    if (config_.overlay) host.serve("memoryView", std::make_shared<CameraServant>(overlay_, "memoryView"));
    loop_->start([this](const auto& observation, const auto& result) { publish(observation, result); },
                 [this](SourceState state, const std::string& why) {
                   const auto shown = state == SourceState::kFinished ? state : SourceState::kWaiting;
                   memory_.setState(shown, "nothing is seen: " + why);
                   gaze_statuses_.setState(shown, "nothing is seen: " + why);
                   overlay_.setState(shown, "nothing is seen: " + why);
                 },
                 [&host](std::exception_ptr failure) { host.fail(std::move(failure)); });
  }

  void stop() override {
    if (loop_) loop_->stop();
    memory_.stop();
    gaze_statuses_.stop();
    overlay_.stop();
  }

 private:
  void publish(const RobotObservation& observation, const AttentiveVisualMemory::StepResult& result) {
    gaze_statuses_.publish(result.gaze);
    const std::uint64_t revision = result.update.snapshot ? result.update.snapshot->revision : 0;
    if (revision == published_) return;  // a frame that was not analysed
    published_ = revision;
    memory_.publish(result.update);
    if (!config_.overlay) return;
    const StampUs now = observation.frame.stamp_us;
    const StampUs interval = toStampUs(1.0 / overlay_rate_hz_);
    const bool time_went_back = overlay_stamp_us_ && now < *overlay_stamp_us_;
    if (overlay_stamp_us_ && !time_went_back && now < *overlay_stamp_us_ + interval) return;
    overlay_stamp_us_ = now;
    Frame view = observation.frame;
    view.image = drawAnalysis(view.image, *result.update.analysis);
    overlay_.publish(std::move(view));
  }

  const ActiveVisualMemoryConfig config_;
  const std::shared_ptr<const Palette> palette_;
  SharedGazeClient gaze_;
  std::atomic<double> overlay_rate_hz_;
  MemoryBroadcaster memory_;
  GazeBroadcaster gaze_statuses_;
  FrameBroadcaster overlay_;
  std::unique_ptr<RemoteFrameSource> camera_;
  std::unique_ptr<RemoteMobileBase> base_;
  std::unique_ptr<RemotePanTiltUnit> pan_tilt_;
  std::unique_ptr<CalibratedBase> calibrated_base_;
  std::unique_ptr<CalibratedPanTilt> calibrated_pan_tilt_;
  std::uint64_t published_ = 0;              ///< of the loop's thread
  std::optional<StampUs> overlay_stamp_us_;  ///< of the last one drawn; of the loop's thread
  std::unique_ptr<PerceptionLoop> loop_;     ///< last member: its threads use all of the above
};

}  // namespace

std::unique_ptr<Component> makeActiveVisualMemory(const ActiveVisualMemoryConfig& config) {
  std::shared_ptr<const Palette> palette;
  if (!config.palette.empty()) palette = std::make_shared<Palette>(loadPalette(config.palette));
  return std::make_unique<ActiveVisualMemory>(config, std::move(palette));
}

ComponentSpec activeVisualMemorySpec() {
  ComponentSpec spec;
  spec.name = "active_visual_memory";
  spec.prefix = "ActiveVisualMemory";
  spec.summary =
      "Remembers the floor segments around the robot and turns its camera to what is worth a look.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9970";
  spec.default_web_endpoints = "ws -h 127.0.0.1 -p 11004";
  spec.configure = [](ConfigReader& root) -> std::unique_ptr<Component> {
    ConfigReader reader = root.group("ActiveVisualMemory");
    const ActiveVisualMemoryConfig config = readActiveVisualMemoryConfig(reader);
    if (!reader.good()) return nullptr;
    return makeActiveVisualMemory(config);
  };
  return spec;
}

}  // namespace vismem
