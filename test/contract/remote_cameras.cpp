// The Ice client of a served camera under the contract of FrameSource, for each format on the wire.
#include "common/robot_ice/camera_ice.h"
#include "contract/frame_source_contract.h"
#include "drivers/example_camera/pattern_camera.h"
#include "robot_ice/loopback.h"

namespace vismem {
namespace {

class RemoteRig : public FrameSourceRig {
 public:
  RemoteRig(Supply supply, FrameFormat format) : camera_(16) {
    camera_.configure({64, 48, supply == Supply::kSteady ? 50.0 : 0.01});
    camera_.start();
    broadcaster_.start(camera_);
    server_.add("cameraA", std::make_shared<CameraServant>(broadcaster_, "cameraA"));
    server_.activate();
    remote_ =
        std::make_unique<RemoteFrameSource>(client_.proxy<avm::CameraPrx>("cameraA", server_.port()), format);
  }
  ~RemoteRig() override {
    server_.deactivate();
    broadcaster_.stop();
    camera_.stop();
  }
  FrameSource& source() override { return *remote_; }
  double period_s() const override { return 0.02; }

 private:
  PatternCamera camera_;
  FrameBroadcaster broadcaster_;
  LoopbackServer server_;
  LoopbackClient client_;
  std::unique_ptr<RemoteFrameSource> remote_;
};

FrameSourceCase caseOf(const std::string& name, FrameFormat format) {
  return {name, [format](Supply supply) { return std::make_unique<RemoteRig>(supply, format); }};
}

INSTANTIATE_TEST_SUITE_P(Ice, FrameSourceContract,
                         testing::Values(caseOf("rgb8", FrameFormat::kRgb8),
                                         caseOf("gray8", FrameFormat::kGray8),
                                         caseOf("jpeg", FrameFormat::kJpeg),
                                         caseOf("yuy2", FrameFormat::kYuy2)),
                         nameOfCase);

}  // namespace
}  // namespace vismem
