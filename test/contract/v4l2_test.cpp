// The driver of V4L2's cameras under the contract of FrameSource, with cameras on umockdev.
#include "common/config/config_reader.h"
#include "contract/frame_source_contract.h"
#include "drivers/camera_v4l2/v4l2_camera.h"
#include "support/emulated_camera.h"

namespace vismem {
namespace {

class Rig : public FrameSourceRig {
 public:
  explicit Rig(const std::string& fourcc) : camera_(describe(fourcc)) {
    const auto properties = Properties::parse("Device=" + camera_.path() + "\n", "rig.cfg");
    ConfigReader config(properties);
    source_ = makeV4l2Camera(config);
    config.finish();
  }
  FrameSource& source() override { return *source_; }
  double period_s() const override { return 1.0 / kRate_hz; }
  void hush() override { camera_.hush(); }

 private:
  static constexpr int kRate_hz = 50;
  static EmulatedCamera::Description describe(const std::string& fourcc) {
    // The next rig is made before the last one is gone.
    static int next_number = 0;
    EmulatedCamera::Description description;
    description.number = next_number++;
    description.modes = {{fourcc, 160, 120, {kRate_hz, 25}}, {fourcc, 320, 240, {kRate_hz}}};
    return description;
  }

  EmulatedCamera camera_;
  std::unique_ptr<FrameSource> source_;
};

FrameSourceCase caseOf(const std::string& fourcc) {
  return {fourcc, [fourcc](Supply) { return std::make_unique<Rig>(fourcc); }};
}

INSTANTIATE_TEST_SUITE_P(V4l2, FrameSourceContract, testing::Values(caseOf("YUYV"), caseOf("MJPG")),
                         nameOfCase);

}  // namespace
}  // namespace vismem
