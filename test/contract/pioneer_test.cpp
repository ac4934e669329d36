// The Pioneer's driver under the contract of MobileBase, with a robot on a pseudo terminal.
#include "contract/mobile_base_contract.h"
#include "drivers/pioneer_p2os/pioneer_base.h"
#include "support/p2os_robot.h"

namespace vismem::contract {
namespace {

class Pioneer : public Subject<MobileBase> {
 public:
  MobileBase& port() override { return base_; }

 private:
  static P2osRobot::Traits traits() {
    P2osRobot::Traits traits;
    traits.sip_period = 50ms;
    return traits;
  }
  static PioneerBase::Params params(const std::string& port) {
    PioneerBase::Params params;
    params.port = port;
    // A busy machine may hold the emulated robot up; silence has its own tests.
    params.silent_after = params.lost_after = 10s;
    return params;
  }
  P2osRobot robot_{traits()};
  PioneerBase base_{params(robot_.path())};
};

const auto kBases = testing::Values(
    MobileBaseImplementation{"P2os", [] { return std::unique_ptr<Subject<MobileBase>>(new Pioneer); }});
INSTANTIATE_TEST_SUITE_P(Pioneer, MobileBaseSamples, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Pioneer, MobileBaseMotion, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Pioneer, MobileBaseThreads, kBases, ImplementationName());

}  // namespace
}  // namespace vismem::contract
