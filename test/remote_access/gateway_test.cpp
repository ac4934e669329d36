// Who may do what through the gateway of deploy/gateway: real routers of Glacier2 with TLS, real components.
#include "remote_access/gateway.h"

#include <avm/base.h>
#include <avm/camera.h>
#include <avm/component.h>
#include <avm/simulation.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "common/process/operation_table.h"
#include "remote_access/served_robot.h"
#include "support/build_paths.h"
#include "support/eventually.h"
#include "support/ice_client.h"

namespace vismem::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

enum class Outcome { kPassed, kNoObject, kNoOperation, kNoSession };

/// Calls an operation without parameters: one that has some answers that they are missing, and does nothing.
Outcome call(const std::shared_ptr<Ice::ObjectPrx>& object, const SliceOperation& operation) {
  const auto mode = operation.idempotent ? Ice::OperationMode::Idempotent : Ice::OperationMode::Normal;
  Ice::ByteSeq result;
  try {
    object->ice_invoke(operation.name, mode, Ice::ByteSeq{}, result);
  } catch (const Ice::ObjectNotExistException&) {
    return Outcome::kNoObject;
  } catch (const Ice::OperationNotExistException&) {
    return Outcome::kNoOperation;
  } catch (const Ice::UnknownException&) {
    // It was reached.
  } catch (const Ice::LocalException&) {
    return Outcome::kNoSession;
  }
  return Outcome::kPassed;
}

/// One robot and its gateway for all roles.
class Roles : public testing::Test {
 protected:
  using Counts = std::array<std::map<Outcome, int>, 2>;

  static void SetUpTestSuite() {
    robot_ = std::make_unique<ServedRobot>();
    std::vector<std::string> endpoints;
    for (const auto& process : robot_->processes()) endpoints.push_back(robot_->endpoints(*process, false));
    gateway_ = std::make_unique<Gateway>(endpoints, std::map<std::string, std::string>{});
  }
  static void TearDownTestSuite() {
    gateway_.reset();
    robot_.reset();
  }

  static bool isReading(const ServedObject& object, const SliceOperation& operation) {
    const auto ids = robot_->proxy(object, Ice::stringToIdentity(object.identity), false)->ice_ids();
    return readingOperations({ids.begin(), ids.end()}).contains(operation.name);
  }
  static std::string at(const ServedObject& object, const std::string& identity) {
    return identity + ":" + robot_->endpoints(*object.process, false);
  }

  /// Tries every operation of every object. @param proxy_of an object. @return outcomes of reading [0] and
  /// changing [1] operations.
  template <typename ProxyOf>
  static Counts tryAll(const ProxyOf& proxy_of) {
    Counts counts;
    for (const ServedObject& object : robot_->objects()) {
      for (const SliceOperation& operation : object.interface->operations)
        ++counts[isReading(object, operation) ? 0 : 1][call(proxy_of(object), operation)];
    }
    return counts;
  }

  static inline std::unique_ptr<ServedRobot> robot_;
  static inline std::unique_ptr<Gateway> gateway_;
};

TEST_F(Roles, AnOperatorCallsEverything) {
  const auto session = gateway_->operatorSession();
  const auto [reading, changing] =
      tryAll([&](const auto& object) { return session->find(at(object, object.identity)); });
  EXPECT_EQ(reading.size(), 1u);
  EXPECT_GT(reading.at(Outcome::kPassed), 50);
  EXPECT_EQ(changing.size(), 1u);
  EXPECT_GT(changing.at(Outcome::kPassed), 50);
}

TEST_F(Roles, AViewerReadsEverythingAndChangesNothing) {
  const auto session = gateway_->viewerSession();
  const auto [reading, changing] =
      tryAll([&](const auto& object) { return session->find(at(object, "robot.view/" + object.face_name)); });
  EXPECT_EQ(reading.size(), 1u);
  EXPECT_GT(reading.at(Outcome::kPassed), 50);
  EXPECT_EQ(changing.size(), 1u);
  EXPECT_GT(changing.at(Outcome::kNoOperation), 50);
}

TEST_F(Roles, AViewerReachesNoOtherIdentity) {
  const auto session = gateway_->viewerSession();
  for (const auto& kind :
       tryAll([&](const auto& object) { return session->find(at(object, object.identity)); })) {
    EXPECT_EQ(kind.size(), 1u);
    EXPECT_GT(kind.at(Outcome::kNoObject), 50);
  }
}

TEST_F(Roles, SomebodyWithoutALoginCallsNothing) {
  int calls = 0;
  for (const bool viewer : {false, true}) {
    for (const std::string category : {"", "robot.view/"}) {
      const auto outsider = gateway_->connect(viewer);
      const std::string router = ":ssl -h 127.0.0.1 -p " + std::to_string(gateway_->port(viewer));
      const auto behind = tryAll([&](const auto& object) {
        return outsider->find(at(object, category.empty() ? object.identity : category + object.face_name));
      });
      const auto at_router = tryAll([&](const auto& object) {
        return outsider->direct((category.empty() ? object.identity : category + object.face_name) + router);
      });
      for (const auto& counts : {behind, at_router}) {
        for (const auto& kind : counts) {
          EXPECT_FALSE(kind.contains(Outcome::kPassed)) << kind.at(Outcome::kPassed) << " calls passed";
          for (const auto& [outcome, count] : kind) calls += count;
        }
      }
    }
  }
  EXPECT_GT(calls, 500);
}

TEST_F(Roles, AnOperatorReachesNoOtherPort) {
  // Also not the verifiers of passwords, which a local program may ask.
  const auto session = gateway_->operatorSession();
  EXPECT_THROW(session->find(gateway_->access().proxy("operators"))->ice_ping(), Ice::LocalException);
  EXPECT_NO_THROW(
      gateway_->operatorSession()->find(at(robot_->objects()[0], robot_->objects()[0].identity))->ice_ping());
}

TEST_F(Roles, APasswordIsForItsOwnRouter) {
  EXPECT_THROW(gateway_->connect(false)->logIn(Gateway::kViewer, Gateway::kPassword),
               Glacier2::PermissionDeniedException);
  EXPECT_THROW(gateway_->connect(true)->logIn(Gateway::kOperator, Gateway::kPassword),
               Glacier2::PermissionDeniedException);
}

TEST_F(Roles, ABrowsersTransportIsServedToo) {
  const auto session = gateway_->connect(true, "wss");
  session->logIn(Gateway::kViewer, Gateway::kPassword);
  for (const ServedObject& object : robot_->objects())
    EXPECT_NO_THROW(session->find(at(object, "robot.view/" + object.face_name))->ice_ping());
}

std::unique_ptr<ComponentProcess> startSimulator(std::vector<std::string> more) {
  std::vector<std::string> arguments{"cfg/sim/simulator.cfg", "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  auto simulator = std::make_unique<ComponentProcess>("simulator", arguments, options);
  EXPECT_TRUE(simulator->waitUntilReady());
  return simulator;
}

TEST(TwoRobots, OfEqualComponentsAreNeverMistaken) {
  const auto robot7 = startSimulator(
      {"--Robot.Name=robot7", "--Simulator.Camera.Width_px=64", "--Simulator.Camera.Height_px=48"});
  const auto robot8 = startSimulator(
      {"--Robot.Name=robot8", "--Simulator.Camera.Width_px=80", "--Simulator.Camera.Height_px=60"});
  const Gateway gateway({robot7->proxy("x"), robot8->proxy("x")}, {});
  const auto session = gateway.operatorSession();
  const auto eye7 = session->find<avm::CameraPrx>(robot7->proxy("robot7/cameraA"));
  const auto eye8 = session->find<avm::CameraPrx>(robot8->proxy("robot8/cameraA"));
  int wrong = 0;
  for (int i = 0; i < 5000; ++i) {
    if (eye7->getInfo().width != 64) ++wrong;
    if (eye8->getInfo().width != 80) ++wrong;
  }
  EXPECT_EQ(wrong, 0);
  // A proxy with the other robot's address leads to nobody, instead of to the robot of the identity.
  EXPECT_THROW(gateway.operatorSession()->find(robot7->proxy("robot8/cameraA"))->ice_ping(),
               Ice::ObjectNotExistException);
}

class OneCommander : public testing::Test {
 protected:
  std::string motors(const ComponentProcess& simulator) { return simulator.proxy("Motors"); }
  avm::TruthSample truth() {
    const auto batch = world_->truthSince(std::numeric_limits<std::int64_t>::min());
    return batch.samples.empty() ? avm::TruthSample{} : batch.samples.back();
  }
  static double distance(const avm::TruthSample& a, const avm::TruthSample& b) {
    return std::hypot(a.robotInWorld.x - b.robotInWorld.x, a.robotInWorld.y - b.robotInWorld.y);
  }
  static std::shared_ptr<avm::BasePrx> with(const std::shared_ptr<avm::BasePrx>& base,
                                            const avm::Lease& lease) {
    return Ice::uncheckedCast<avm::BasePrx>(base->ice_context({{"lease", lease.id}}));
  }
  static bool isRefused(const std::shared_ptr<avm::BasePrx>& base) {
    try {
      base->setVelocity(0.3, 0.0);
      return false;
    } catch (const avm::LeaseRefused&) {
      return true;
    }
  }

  std::unique_ptr<ComponentProcess> simulator_ = startSimulator({});
  Gateway gateway_{{simulator_->proxy("x")}, {{"Base", simulator_->proxy("Motors")}}};
  IceClient local_;
  std::shared_ptr<avm::SimulationPrx> world_ = local_.find<avm::SimulationPrx>(*simulator_, "Simulation");
};

TEST_F(OneCommander, ASecondOperatorDoesNotMoveTheRobot) {
  const auto ana = gateway_.operatorSession();
  const auto ben = gateway_.operatorSession(Gateway::kSecondOperator);
  const auto base_ana = ana->find<avm::BasePrx>(motors(*simulator_));
  const auto base_ben = ben->find<avm::BasePrx>(motors(*simulator_));
  const auto lease = base_ana->acquire("ana", 10, 60.0);
  const auto start = truth();
  int samples = 0;
  for (const auto end = std::chrono::steady_clock::now() + 2s; std::chrono::steady_clock::now() < end;
       ++samples) {
    EXPECT_TRUE(isRefused(base_ben));
    EXPECT_EQ(base_ben->setV(0.3F), -1);
    EXPECT_EQ(distance(start, truth()), 0.0);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_GT(samples, 20);
  EXPECT_TRUE(eventually([&] {
    with(base_ana, lease)->setVelocity(0.3, 0.0);
    return distance(start, truth()) > 0.05;
  })) << "the holder moves it";
}

TEST_F(OneCommander, OperatorsWithoutALeaseAreDistinguished) {
  // The router has one connection for both.
  const auto ana = gateway_.operatorSession();
  const auto ben = gateway_.operatorSession(Gateway::kSecondOperator);
  const auto base_ana = ana->find<avm::BasePrx>(motors(*simulator_));
  const auto base_ben = ben->find<avm::BasePrx>(motors(*simulator_));
  EXPECT_TRUE(eventually([&] { return base_ana->setV(0.1F) == 0 && base_ben->setV(-0.1F) == -1; }));
}

TEST_F(OneCommander, ALeaseEndsWithItsSession) {
  auto ana = gateway_.operatorSession();
  const auto ben = gateway_.operatorSession(Gateway::kSecondOperator);
  const auto base_ana = ana->find<avm::BasePrx>(motors(*simulator_));
  const auto base_ben = ben->find<avm::BasePrx>(motors(*simulator_));
  const auto lease = base_ana->acquire("ana", 10, 60.0);
  with(base_ana, lease)->setVelocity(0.3, 0.0);
  EXPECT_TRUE(isRefused(base_ben));
  ana.reset();
  EXPECT_TRUE(eventually([&] { return !base_ben->holder().held; }, 1s)) << "it would last 60 s by itself";
  EXPECT_EQ(base_ben->getV(), 0.0F);
  EXPECT_NO_THROW(base_ben->acquire("ben", 0, 1.0));
}

TEST_F(OneCommander, AHigherPriorityTakesOver) {
  const auto ana = gateway_.operatorSession();
  const auto ben = gateway_.operatorSession(Gateway::kSecondOperator);
  const auto base_ana = ana->find<avm::BasePrx>(motors(*simulator_));
  const auto base_ben = ben->find<avm::BasePrx>(motors(*simulator_));
  const auto low = base_ana->acquire("ana", 10, 60.0);
  EXPECT_THROW(base_ben->acquire("ben", 10, 60.0), avm::LeaseRefused);
  const auto high = base_ben->acquire("ben", 20, 60.0);
  EXPECT_TRUE(isRefused(with(base_ana, low)));
  EXPECT_NO_THROW(with(base_ben, high)->setVelocity(0.1, 0.0));
}

TEST_F(OneCommander, WrongLoginsAreHeldToFiveAMinuteForAnAddress) {
  const auto reasonOf = [&](bool viewer, const std::string& user,
                            const std::string& password) -> std::string {
    try {
      gateway_.connect(viewer)->logIn(user, password);
    } catch (const Glacier2::PermissionDeniedException& denied) {
      return denied.reason;
    }
    return "logged in";
  };
  const auto stands = gateway_.operatorSession();
  int looked_at = 0;
  for (int i = 0; i < 40; ++i) {
    // Also at the other router, and for users who do not exist.
    const auto reason =
        reasonOf(i % 2 == 1, i % 3 == 0 ? "nobody" : Gateway::kOperator, "wrong " + std::to_string(i));
    if (reason == "wrong user or password")
      ++looked_at;
    else
      EXPECT_THAT(reason, HasSubstr("too many wrong logins: try again in "));
  }
  EXPECT_EQ(looked_at, 5);
  EXPECT_THAT(reasonOf(false, Gateway::kOperator, Gateway::kPassword), HasSubstr("too many"));
  EXPECT_NO_THROW(stands->find(motors(*simulator_))->ice_ping()) << "a session that stands goes on";
  EXPECT_THAT(gateway_.access().error(), HasSubstr("wrong login: ana at 127.0.0.1 as operators"));
  EXPECT_THAT(gateway_.access().error(), testing::Not(HasSubstr("wrong 1")));
}

}  // namespace
}  // namespace vismem::test
