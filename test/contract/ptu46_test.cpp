// The PTU-46's driver under the contract of PanTiltUnit, with a unit on a pseudo terminal.
#include "contract/pantilt_contract.h"
#include "drivers/ptu46/ptu46_unit.h"
#include "support/ptu46_device.h"

namespace vismem::contract {
namespace {

class Ptu46 : public Subject<PanTiltUnit> {
 public:
  PanTiltUnit& port() override { return unit_; }

 private:
  static Ptu46Unit::Params params(const std::string& port) {
    Ptu46Unit::Params params;
    params.port = port;
    return params;
  }
  Ptu46Device device_;
  Ptu46Unit unit_{params(device_.path())};
};

const auto kUnits = testing::Values(
    PanTiltImplementation{"Ptu46", [] { return std::unique_ptr<Subject<PanTiltUnit>>(new Ptu46); }});
INSTANTIATE_TEST_SUITE_P(Serial, PanTiltSamples, kUnits, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Serial, PanTiltMotion, kUnits, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Serial, PanTiltThreads, kUnits, ImplementationName());

}  // namespace
}  // namespace vismem::contract
