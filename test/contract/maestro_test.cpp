// The Maestro's driver under the contract of PanTiltUnit, with a controller on umockdev's USB.
#include "contract/pantilt_contract.h"
#include "drivers/pololu_maestro/maestro_pan_tilt.h"
#include "support/emulated_maestro.h"

namespace vismem::contract {
namespace {

template <std::uint16_t kProduct>
class Maestro : public Subject<PanTiltUnit> {
 public:
  PanTiltUnit& port() override { return *unit_; }

 private:
  EmulatedMaestro device_{kProduct};
  Properties properties_ = Properties::parse("", "defaults.cfg");
  ConfigReader config_{properties_};
  std::unique_ptr<PanTiltUnit> unit_ = makeMaestroPanTilt(config_);
};

template <std::uint16_t kProduct>
std::unique_ptr<Subject<PanTiltUnit>> make() {
  return std::make_unique<Maestro<kProduct>>();
}

const PanTiltImplementation kMicro{"Micro6", make<0x0089>};
const auto kUnits = testing::Values(kMicro, PanTiltImplementation{"Mini12", make<0x008A>});
INSTANTIATE_TEST_SUITE_P(Maestro, PanTiltSamples, testing::Values(kMicro), ImplementationName());
INSTANTIATE_TEST_SUITE_P(Maestro, PanTiltMotion, kUnits, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Maestro, PanTiltThreads, testing::Values(kMicro), ImplementationName());

}  // namespace
}  // namespace vismem::contract
