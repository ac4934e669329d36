// The driver of cameras with pan-tilt motors under the contract of PanTiltUnit, with cameras on umockdev.
#include <linux/videodev2.h>

#include "contract/pantilt_contract.h"
#include "drivers/pantilt_uvc/uvc_pan_tilt.h"
#include "support/emulated_camera.h"

namespace vismem::contract {
namespace {

template <bool kOrbit>
class Uvc : public Subject<PanTiltUnit> {
 public:
  PanTiltUnit& port() override { return *unit_; }

 private:
  static EmulatedCamera::Description describe() {
    EmulatedCamera::Description description;
    description.orbit = kOrbit;
    constexpr int kDegree = 3600;
    if (!kOrbit) {
      description.controls = {
          {V4L2_CID_PAN_ABSOLUTE, "Pan, Absolute", 1, -70 * kDegree, 70 * kDegree, kDegree / 10, 0, false},
          {V4L2_CID_TILT_ABSOLUTE, "Tilt, Absolute", 1, -30 * kDegree, 30 * kDegree, kDegree / 10, 0, false}};
    }
    return description;
  }
  EmulatedCamera device_{describe()};
  Properties properties_ = Properties::parse(
      "Device=/dev/video0\nRate_hz=50\nResetTakes_s=0\nPan.Rate_degps=150\nTilt.Rate_degps=150\n", "rig.cfg");
  ConfigReader config_{properties_};
  std::unique_ptr<PanTiltUnit> unit_ = makeUvcPanTilt(config_);
};

template <bool kOrbit>
std::unique_ptr<Subject<PanTiltUnit>> make() {
  return std::make_unique<Uvc<kOrbit>>();
}

const PanTiltImplementation kAbsolute{"Absolute", make<false>};
const auto kUnits = testing::Values(kAbsolute, PanTiltImplementation{"Orbit", make<true>});
INSTANTIATE_TEST_SUITE_P(Uvc, PanTiltSamples, testing::Values(kAbsolute), ImplementationName());
INSTANTIATE_TEST_SUITE_P(Uvc, PanTiltMotion, kUnits, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Uvc, PanTiltThreads, testing::Values(kAbsolute), ImplementationName());

}  // namespace
}  // namespace vismem::contract
