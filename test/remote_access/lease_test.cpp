// One operator at a time: the lease of base and pan-tilt unit over Ice, with a real simulator.
#include <avm/base.h>
#include <avm/component.h>
#include <avm/pantilt.h>
#include <avm/simulation.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "support/build_paths.h"
#include "support/eventually.h"
#include "support/ice_client.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class LeaseOverIce : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(simulator_.waitUntilReady()); }

  template <typename Prx>
  static std::shared_ptr<Prx> with(const std::shared_ptr<Prx>& proxy, const avm::Lease& lease) {
    return Ice::uncheckedCast<Prx>(proxy->ice_context({{"lease", lease.id}}));
  }
  /// The newest true pose of the robot.
  avm::TruthSample truth() {
    const auto batch = world_->truthSince(std::numeric_limits<std::int64_t>::min());
    return batch.samples.empty() ? avm::TruthSample{} : batch.samples.back();
  }
  static double distance(const avm::TruthSample& a, const avm::TruthSample& b) {
    return std::hypot(a.robotInWorld.x - b.robotInWorld.x, a.robotInWorld.y - b.robotInWorld.y);
  }
  static std::string refusalOf(const std::function<void()>& call) {
    try {
      call();
    } catch (const avm::LeaseRefused& refused) {
      return refused.reason;
    }
    return "";
  }

  static ChildProcess::Options inSources() {
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    return options;
  }

  ComponentProcess simulator_{
      "simulator", {"cfg/sim/simulator.cfg", "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0"}, inSources()};
  IceClient one_;
  IceClient two_;  // another connection
  std::shared_ptr<avm::BasePrx> base_one_ = one_.find<avm::BasePrx>(simulator_, "Motors");
  std::shared_ptr<avm::BasePrx> base_two_ = two_.find<avm::BasePrx>(simulator_, "Motors");
  std::shared_ptr<avm::SimulationPrx> world_ = two_.find<avm::SimulationPrx>(simulator_, "Simulation");
};

TEST_F(LeaseOverIce, TheSecondOperatorDoesNotMoveTheRobot) {
  const auto lease = base_one_->acquire("gui-1", 10, 60.0);
  const auto start = truth();
  const auto end = std::chrono::steady_clock::now() + 1500ms;
  int refused = 0;
  while (std::chrono::steady_clock::now() < end) {
    try {
      base_two_->setVelocity(0.3, 0.0);
    } catch (const avm::LeaseRefused& refusal) {
      ++refused;
      EXPECT_EQ(refusal.holder.client, "gui-1");
      EXPECT_EQ(refusal.holder.priority, 10);
      EXPECT_FALSE(refusal.holder.implicit);
      EXPECT_THAT(refusal.reason, HasSubstr("gui-1 holds the lease"));
    }
    EXPECT_EQ(base_two_->setV(0.3F), -1) << "JdeRobot's clients know no exception";
    EXPECT_EQ(base_two_->setW(0.3F), -1);
    EXPECT_EQ(distance(start, truth()), 0.0);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_GT(refused, 10);
  const auto leased = with(base_one_, lease);
  EXPECT_TRUE(eventually([&] {
    leased->setVelocity(0.3, 0.0);
    return distance(start, truth()) > 0.05;
  })) << "the holder moves it";
}

TEST_F(LeaseOverIce, ALeaseEndsByItselfByReleaseAndByAHigherPriority) {
  const auto brief = base_one_->acquire("brief", 10, 0.3);
  EXPECT_TRUE(base_two_->holder().held);
  EXPECT_TRUE(eventually([&] { return !base_two_->holder().held; }));
  EXPECT_THAT(refusalOf([&] { base_one_->renew(brief.id); }), "the lease has ended");
  EXPECT_THAT(refusalOf([&] { with(base_one_, brief)->setVelocity(0.1, 0.0); }), "the lease has ended");

  const auto low = base_one_->acquire("low", 10, 60.0);
  EXPECT_THAT(refusalOf([&] { base_two_->acquire("equal", 10, 1.0); }),
              HasSubstr("low holds the lease (priority 10"));
  const auto high = base_two_->acquire("high", 20, 60.0);
  EXPECT_THAT(refusalOf([&] { with(base_one_, low)->setVelocity(0.1, 0.0); }),
              HasSubstr("high holds the lease"));
  EXPECT_TRUE(base_one_->release(low.id).adjusted) << "it had ended";
  EXPECT_EQ(base_one_->holder().client, "high");

  EXPECT_FALSE(base_two_->release(high.id).adjusted);
  EXPECT_FALSE(base_one_->holder().held);
  EXPECT_EQ(base_one_->setV(0.1F), 0) << "free for JdeRobot's clients again";
}

TEST_F(LeaseOverIce, ReleaseStopsTheBase) {
  const auto lease = base_one_->acquire("gui", 10, 60.0);
  const auto leased = with(base_one_, lease);
  // Within the watchdog's time.
  EXPECT_TRUE(eventually([&] {
    leased->setVelocity(0.3, 0.0);
    return leased->getV() == 0.3F;
  }));
  leased->setVelocity(0.3, 0.0);
  leased->release(lease.id);
  EXPECT_EQ(base_two_->getV(), 0.0F);
}

TEST_F(LeaseOverIce, AClientWithoutALeaseHasAnImplicitOne) {
  avm::LeaseState holder;
  EXPECT_TRUE(eventually([&] {
    if (base_one_->setV(0.1F) != 0) return false;
    holder = base_two_->holder();
    return holder.held && base_two_->setV(0.1F) == -1;
  })) << "one operator at a time";
  EXPECT_TRUE(holder.implicit);
  EXPECT_EQ(holder.priority, 0);
  EXPECT_THAT(holder.client, HasSubstr("127.0.0.1:"));
  EXPECT_TRUE(eventually([&] { return base_two_->setV(0.1F) == 0; })) << "it ends after the last command";
  const auto gui = base_one_->acquire("gui", 1, 60.0);
  EXPECT_EQ(base_two_->setV(0.1F), -1);
  EXPECT_NO_THROW(with(base_one_, gui)->setVelocity(0.1, 0.0));
}

TEST_F(LeaseOverIce, AnyoneStopsTheBaseAndNobodyMovesItForAWhile) {
  const auto lease = base_one_->acquire("gui", 100, 60.0);
  const auto leased = with(base_one_, lease);
  leased->setVelocity(0.3, 0.0);
  base_two_->stop();
  EXPECT_EQ(base_two_->getV(), 0.0F);
  EXPECT_EQ(base_two_->holder().client, "stop");
  EXPECT_THAT(refusalOf([&] { leased->setVelocity(0.3, 0.0); }),
              HasSubstr("stopped: no command for another"));
  EXPECT_THAT(refusalOf([&] { base_one_->acquire("gui", 100, 60.0); }), HasSubstr("stopped"));
  EXPECT_TRUE(eventually([&] { return !base_two_->holder().held; }));
  EXPECT_THAT(refusalOf([&] { leased->setVelocity(0.3, 0.0); }), "the lease has ended");
  EXPECT_NO_THROW(base_two_->acquire("other", 0, 1.0));
}

// What a router of Glacier2 adds to a call with Glacier2.AddConnectionContext.
Ice::Context behindGateway(const std::string& port) {
  return {{"_con.remoteAddress", "10.77.0.9"}, {"_con.remotePort", port}};
}

TEST_F(LeaseOverIce, EndsWithTheSessionOfItsGateway) {
  const auto ana = behindGateway("51234");
  const auto lease = base_one_->acquire("ana", 10, 60.0, ana);
  base_one_->setVelocity(0.3, 0.0, {{"lease", lease.id}});
  EXPECT_TRUE(base_two_->endSession("10.77.0.9:51235").adjusted) << "another session";
  EXPECT_EQ(base_two_->holder().client, "ana");
  EXPECT_FALSE(base_two_->endSession("10.77.0.9:51234").adjusted);
  EXPECT_FALSE(base_two_->holder().held);
  EXPECT_EQ(base_two_->getV(), 0.0F) << "what was commanded by speed stops";
}

TEST_F(LeaseOverIce, ClientsOfOneGatewayAreDistinguished) {
  // One connection, that of the router, carries the commands of both.
  const auto command = [&](const Ice::Context& context) { return base_one_->setV(0.1F, context); };
  EXPECT_TRUE(eventually([&] {
    return command(behindGateway("1")) == 0 && command(behindGateway("2")) == -1 && command({}) == -1;
  }));
  EXPECT_TRUE(eventually([&] {
    command(behindGateway("1"));
    return base_two_->holder().client == "10.77.0.9:1";
  }));
}

TEST_F(LeaseOverIce, WrongArgumentsAreNamed) {
  const auto reason = [&](const std::string& client, int priority, double timeout_s) -> std::string {
    try {
      base_one_->acquire(client, priority, timeout_s);
    } catch (const avm::InvalidArgument& wrong) {
      return wrong.reason;
    }
    return "";
  };
  EXPECT_EQ(reason("", 1, 1.0), "client has 0 characters (must have 1..100)");
  EXPECT_EQ(reason(std::string(101, 'x'), 1, 1.0), "client has 101 characters (must have 1..100)");
  EXPECT_THAT(reason("gui", 101, 1.0), HasSubstr("priority"));
  EXPECT_THAT(reason("gui", -1, 1.0), HasSubstr("priority"));
  EXPECT_THAT(reason("gui", 1, 0.05), HasSubstr("timeoutS"));
  EXPECT_THAT(reason("gui", 1, std::numeric_limits<double>::quiet_NaN()), HasSubstr("timeoutS"));
  EXPECT_FALSE(base_one_->holder().held);
}

TEST_F(LeaseOverIce, ThePanTiltUnitHasALeaseOfItsOwn) {
  const auto unit_one = one_.find<avm::PanTiltPrx>(simulator_, "PanTilt");
  const auto unit_two = two_.find<avm::PanTiltPrx>(simulator_, "PanTilt");
  const auto lease = unit_one->acquire("gui", 10, 60.0);
  EXPECT_THAT(refusalOf([&] { unit_two->moveTo({0.5, 0.0}, 0.0, 0.0); }), HasSubstr("gui holds the lease"));
  EXPECT_THAT(refusalOf([&] { unit_two->setRates(0.5, 0.0); }), HasSubstr("gui holds the lease"));
  EXPECT_EQ(unit_two->setPTMotorsData(std::make_shared<jderobot::PTMotorsData>(10.F, 0.F, 0.F, 0.F, 0)), -1);
  EXPECT_EQ(unit_two->setPose3DMotorsData(std::make_shared<jderobot::Pose3DMotorsData>()), -1);
  EXPECT_NO_THROW(base_two_->setVelocity(0.0, 0.0)) << "the base is free";

  // Given back, what turned by a speed stands.
  const auto leased = with(unit_one, lease);
  leased->setRates(0.4, 0.0);
  const auto pan = [&] {
    const auto batch = unit_two->samplesSince(std::numeric_limits<std::int64_t>::min());
    return batch.samples.empty() ? 0.0 : batch.samples.back().panRad;
  };
  ASSERT_TRUE(eventually([&] { return pan() > 0.05; }));
  leased->release(lease.id);
  EXPECT_TRUE(eventually([&] {
    const double before = pan();
    std::this_thread::sleep_for(100ms);
    return pan() == before;
  }));
  EXPECT_LT(pan(), 2.0) << "it stands before its limit";
}

TEST_F(LeaseOverIce, SpeedsAreLimitedAtRunTime) {
  const auto component = one_.find<avm::ComponentPrx>(simulator_, "simulator/component");
  component->setParameter("Base.MaximumSpeed_mps", 0.1);
  EXPECT_DOUBLE_EQ(base_one_->getLimits().maxSpeedMps, 0.1);
  const auto reply = base_one_->setVelocity(0.3, 0.0);
  EXPECT_TRUE(reply.adjusted);
  EXPECT_THAT(reply.message, HasSubstr("0.1"));
  EXPECT_TRUE(eventually([&] {
    base_one_->setVelocity(0.3, 0.0);
    return base_one_->getV() == 0.1F;
  }));
  try {
    component->setParameter("Base.MaximumSpeed_mps", 1000.0);
    ADD_FAILURE() << "beyond the base's own limit";
  } catch (const avm::InvalidArgument& wrong) {
    EXPECT_THAT(wrong.reason, HasSubstr("Base.MaximumSpeed_mps = 1000 (must be 0.."));
  }
}

}  // namespace
}  // namespace vismem
