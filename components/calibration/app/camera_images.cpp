#include <chrono>
#include <iostream>

#include "calibration/app/lens_images.h"
#include "common/config/config_error.h"
#include "common/process/ice_failure.h"
#include "common/process/ice_setup.h"
#include "common/process/log.h"
#include "common/robot_ice/camera_ice.h"
#include "common/tool/end_signals.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

class CameraImages : public ImageStream {
 public:
  CameraImages(const std::string& proxy, double seconds)
      : log_("calibrate", LogLevel::kError),
        ice_(makeCommunicator(Properties{}, log_)),
        camera_(proxyOf(proxy)) {
    if (seconds > 0.0)
      end_ =
          Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    const PortReply reply = camera_.start();
    if (!reply.ok()) throw std::runtime_error(proxy + ": " + reply.message);
  }

  std::optional<StampedImage> next() override {
    while (!signals_.arrived() && Clock::now() < end_) {
      FrameResult result = camera_.next(200ms);
      if (result.frame) return StampedImage{result.frame->stamp_us, "image", std::move(result.frame->image)};
      if (result.state == SourceState::kFinished) break;
      if (result.message != reason_ && !result.message.empty()) std::cerr << result.message << "\n";
      reason_ = result.message;
    }
    return std::nullopt;
  }
  bool isContinuous() const override { return true; }
  std::size_t count() const override { return 0; }

 private:
  std::shared_ptr<avm::CameraPrx> proxyOf(const std::string& text) const {
    try {
      const auto proxy = ice_.communicator()->stringToProxy(text);
      if (!proxy)
        throw ConfigError({"--camera: is empty (must be a proxy: \"cameraA:tcp -h 127.0.0.1 -p 9999\")"});
      return Ice::uncheckedCast<avm::CameraPrx>(proxy);
    } catch (const Ice::Exception& error) {
      throw ConfigError({"--camera " + text + ": " + describeFailure(error) +
                         " (must be a proxy: \"cameraA:tcp -h 127.0.0.1 -p 9999\")"});
    }
  }

  EndSignals signals_;  ///< end the stream, not the process: what was collected is used
  Logger log_;
  Ice::CommunicatorHolder ice_;
  RemoteFrameSource camera_;
  Clock::time_point end_ = Clock::time_point::max();
  std::string reason_;
};

}  // namespace

std::unique_ptr<ImageStream> imagesOfCamera(const std::string& proxy, double seconds) {
  return std::make_unique<CameraImages>(proxy, seconds);
}

}  // namespace vismem
