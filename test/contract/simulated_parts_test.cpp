// The drivers with simulated motion, and the Ice clients of the same, served: pan-tilt unit and base.
#include "common/robot_ice/base_ice.h"
#include "common/robot_ice/pantilt_ice.h"
#include "contract/mobile_base_contract.h"
#include "contract/pantilt_contract.h"
#include "drivers/base_simulated/simulated_mobile_base.h"
#include "drivers/pantilt_simulated/simulated_pan_tilt_unit.h"
#include "robot_ice/loopback.h"

namespace vismem::contract {
namespace {

class DriverPanTilt : public Subject<PanTiltUnit> {
 public:
  PanTiltUnit& port() override { return unit_; }

 private:
  SimulatedPanTiltUnit unit_{SimulatedPanTiltUnit::Params{}};
};

class DriverBase : public Subject<MobileBase> {
 public:
  MobileBase& port() override { return base_; }

 private:
  SimulatedMobileBase base_{SimulatedMobileBase::Params{}};
};

class RemotePanTilt : public Subject<PanTiltUnit> {
 public:
  RemotePanTilt() {
    unit_.start();
    servant_->start();
    server_.add("PanTilt", servant_);
    server_.activate();
    remote_ = std::make_unique<RemotePanTiltUnit>(client_.proxy<avm::PanTiltPrx>("PanTilt", server_.port()));
  }
  ~RemotePanTilt() override {
    server_.deactivate();
    servant_->stop();
  }
  PanTiltUnit& port() override { return *remote_; }

 private:
  SimulatedPanTiltUnit unit_{SimulatedPanTiltUnit::Params{}};
  std::shared_ptr<PanTiltServant> servant_ = std::make_shared<PanTiltServant>(unit_);
  LoopbackServer server_;
  LoopbackClient client_;
  std::unique_ptr<RemotePanTiltUnit> remote_;
};

class RemoteBase : public Subject<MobileBase> {
 public:
  RemoteBase() {
    base_.start();
    odometry_->start();
    server_.add("Motors", std::make_shared<BaseServant>(base_));
    server_.add("Encoders", odometry_);
    server_.activate();
    remote_ = std::make_unique<RemoteMobileBase>(client_.proxy<avm::BasePrx>("Motors", server_.port()),
                                                 client_.proxy<avm::OdometryPrx>("Encoders", server_.port()));
  }
  ~RemoteBase() override {
    server_.deactivate();
    odometry_->stop();
  }
  MobileBase& port() override { return *remote_; }

 private:
  SimulatedMobileBase base_{SimulatedMobileBase::Params{}};
  std::shared_ptr<OdometryServant> odometry_ = std::make_shared<OdometryServant>(base_);
  LoopbackServer server_;
  LoopbackClient client_;
  std::unique_ptr<RemoteMobileBase> remote_;
};

template <typename Made, typename Port>
std::unique_ptr<Subject<Port>> make() {
  return std::make_unique<Made>();
}

const auto kPanTilts = testing::Values(PanTiltImplementation{"Driver", make<DriverPanTilt, PanTiltUnit>},
                                       PanTiltImplementation{"Remote", make<RemotePanTilt, PanTiltUnit>});
INSTANTIATE_TEST_SUITE_P(Simulated, PanTiltSamples, kPanTilts, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulated, PanTiltMotion, kPanTilts, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulated, PanTiltThreads, kPanTilts, ImplementationName());

const auto kBases = testing::Values(MobileBaseImplementation{"Driver", make<DriverBase, MobileBase>},
                                    MobileBaseImplementation{"Remote", make<RemoteBase, MobileBase>});
INSTANTIATE_TEST_SUITE_P(Simulated, MobileBaseSamples, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulated, MobileBaseMotion, kBases, ImplementationName());
INSTANTIATE_TEST_SUITE_P(Simulated, MobileBaseThreads, kBases, ImplementationName());

}  // namespace
}  // namespace vismem::contract
