// Who may call what, with real processes: every operation of every object, over tcp and WebSocket, as each
// kind of caller (docs/remote-access.md).
#include <avm/component.h>
#include <avm/localization.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/process/operation_table.h"
#include "remote_access/served_robot.h"
#include "support/build_paths.h"
#include "support/free_ports.h"

namespace vismem::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// One robot for all tests: nothing that they do changes who may call what.
class Faces : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot_ = std::make_unique<ServedRobot>(); }
  static void TearDownTestSuite() { robot_.reset(); }

  static bool isReading(const ServedObject& object, const SliceOperation& operation) {
    std::vector<std::string> ids;
    for (const auto& id : robot_->proxy(object, Ice::stringToIdentity(object.identity), false)->ice_ids())
      ids.push_back(id);
    return readingOperations(ids).contains(operation.name);
  }

  /// Tries every operation of every object under CATEGORY/FACE_NAME.
  /// @return how many calls had each answer, apart for reading [0] and changing [1] operations.
  static std::array<std::map<Answer, int>, 2> tryAll(const std::string& category, bool web) {
    std::array<std::map<Answer, int>, 2> answers;
    for (const ServedObject& object : robot_->objects()) {
      for (const SliceOperation& operation : object.interface->operations) {
        const int kind = isReading(object, operation) ? 0 : 1;
        const Answer answer = robot_->call(object, {object.face_name, category}, web, operation);
        ++answers[kind][answer];
      }
    }
    return answers;
  }

  static inline std::unique_ptr<ServedRobot> robot_;
};

TEST_F(Faces, EveryInterfaceIsServedHere) {
  // Else the tests below would say nothing of its operations.
  std::set<std::string> served;
  for (const ServedObject& object : robot_->objects()) {
    for (const auto& id : robot_->proxy(object, Ice::stringToIdentity(object.identity), false)->ice_ids())
      served.insert(id);
  }
  for (const auto& [id, interface] : robot_->model().interfaces) {
    if (id == "::jderobot::ImageConsumer" || id == "::avm::FleetListener") continue;  // clients' own
    if (id == "::avm::Worker") continue;  // of experiments, never of a robot
    EXPECT_TRUE(served.contains(id)) << id;
  }
}

TEST_F(Faces, AViewerReadsEverythingAndChangesNothing) {
  const std::pair<std::string, bool> faces[] = {{"robot.view", false},
                                                {std::string("robot.view.") + kViewToken, true}};
  for (const auto& [category, web] : faces) {
    const auto [reading, changing] = tryAll(category, web);
    EXPECT_EQ(reading.size(), 1u) << category;
    EXPECT_GT(reading.at(Answer::kPassed), 50) << category;
    EXPECT_EQ(changing.size(), 1u) << category;
    EXPECT_GT(changing.at(Answer::kNoOperation), 50) << category;
  }
}

TEST_F(Faces, AnOperatorCallsEverythingOverWebSocket) {
  const auto [reading, changing] = tryAll(std::string("robot.") + kToken, true);
  EXPECT_EQ(reading.size(), 1u);
  EXPECT_GT(reading.at(Answer::kPassed), 50);
  EXPECT_EQ(changing.size(), 1u);
  EXPECT_GT(changing.at(Answer::kPassed), 50);
}

TEST_F(Faces, OverWebSocketNothingAnswersWithoutAToken) {
  const std::string token = kToken;
  const std::string categories[] = {"",
                                    "robot",
                                    "robot.",
                                    "robot.view",
                                    "robot.view.",
                                    "robot.component",
                                    "robot.view." + token,
                                    "robot." + std::string(kViewToken),
                                    "robot." + token.substr(0, token.size() - 1),
                                    "robot." + token + "x",
                                    token,
                                    "localization",
                                    "simulator"};
  int calls = 0;
  for (const std::string& category : categories) {
    for (const auto& kind : tryAll(category, true)) {
      for (const auto& [answer, count] : kind) {
        EXPECT_EQ(answer, Answer::kNoObject) << count << " calls of category \"" << category << "\"";
        calls += count;
      }
    }
  }
  EXPECT_GT(calls, 1000);
  for (const ServedObject& object : robot_->objects()) {
    const auto plain = robot_->proxy(object, Ice::stringToIdentity(object.identity), true);
    EXPECT_THROW(plain->ice_ping(), Ice::ObjectNotExistException) << object.identity;
    EXPECT_THROW(plain->ice_ids(), Ice::ObjectNotExistException) << object.identity;
    EXPECT_THROW(plain->ice_identity({object.face_name, "robot." + token})->ice_facet("Admin")->ice_ping(),
                 Ice::ObjectNotExistException);
  }
}

TEST_F(Faces, JdeRobotsIdentitiesAnswerOverTcpAsEver) {
  for (const ServedObject& object : robot_->objects()) {
    for (const SliceOperation& operation : object.interface->operations)
      EXPECT_EQ(robot_->call(object, Ice::stringToIdentity(object.identity), false, operation),
                Answer::kPassed)
          << object.identity << " " << operation.name;
  }
}

TEST_F(Faces, NobodyReadsATokenFromTheComponent) {
  for (const ServedObject& object : robot_->objects()) {
    if (!object.identity.ends_with("/component")) continue;
    const auto web = Ice::uncheckedCast<avm::ComponentPrx>(
        robot_->proxy(object, {object.face_name, std::string("robot.") + kToken}, true));
    // Ice warns of failures that no interface declares, with the identity that was called; of many only some.
    EXPECT_TRUE(eventually([&] {
      Ice::ByteSeq ignored;
      EXPECT_THROW(web->ice_invoke("setParameter", Ice::OperationMode::Idempotent, Ice::ByteSeq{}, ignored),
                   Ice::UnknownException);
      return object.process->error().find("robot.***") != std::string::npos;
    })) << "the warning that this test relies on does not come:\n"
        << object.process->error();
    std::string all;
    for (const auto& setting : web->getConfiguration()) all += setting.key + "=" + setting.value + "\n";
    EXPECT_THAT(all, HasSubstr("Endpoints="));
    for (const auto& entry : web->getLog(0, avm::LogLevel::Debug, 1000).entries) all += entry.text + "\n";
    const auto status = web->getStatus();
    all += status.reason;
    for (const auto& error : status.errors) all += error.text + "\n";
    all += object.process->error() + object.process->out();
    EXPECT_THAT(all, Not(HasSubstr(kToken))) << object.component;
    EXPECT_THAT(all, Not(HasSubstr(kViewToken))) << object.component;
  }
}

class OneSimulator : public testing::Test {
 protected:
  /// @param more arguments after those of a simulator at ephemeral ports.
  std::unique_ptr<ComponentProcess> start(std::vector<std::string> more) {
    std::vector<std::string> arguments{"cfg/sim/simulator.cfg",
                                       "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    return std::make_unique<ComponentProcess>("simulator", arguments, options);
  }
  bool answers(const ComponentProcess& process, const std::string& identity) {
    const auto proxy =
        communicator_->stringToProxy(identity + ":tcp -h 127.0.0.1 -p " + std::to_string(process.port()));
    try {
      proxy->ice_ping();
      return true;
    } catch (const Ice::ObjectNotExistException&) {
      return false;
    }
  }
  Ice::CommunicatorHolder communicator_{Ice::initialize()};
};

TEST_F(OneSimulator, OpensNoWebSocketWithoutAToken) {
  const int port = 11000 + freePortOffset();
  const std::string web = "--Simulator.WebEndpoints=ws -h 127.0.0.1 -p " + std::to_string(port);
  const auto closed = start({web});
  ASSERT_TRUE(closed->waitUntilReady());
  EXPECT_TRUE(Listener(port).good()) << "the port is free";
  EXPECT_EQ(closed->port("ws"), 0);
  EXPECT_EQ(closed->stop(kPatience), 0);
  const auto open = start({web, "--Robot.ViewToken=" + std::string(kViewToken)});
  ASSERT_TRUE(open->waitUntilReady());
  EXPECT_EQ(open->port("ws"), port);
  EXPECT_FALSE(Listener(port).good());
}

TEST_F(OneSimulator, WithANameAnswersForThatRobotAlone) {
  const auto robot7 = start({"--Robot.Name=robot7"});
  const auto robot8 = start({"--Robot.Name=robot8"});
  ASSERT_TRUE(robot7->waitUntilReady());
  ASSERT_TRUE(robot8->waitUntilReady());
  for (const auto& [process, name, other] :
       {std::tuple{robot7.get(), "robot7", "robot8"}, std::tuple{robot8.get(), "robot8", "robot7"}}) {
    for (const std::string rest :
         {"/Motors", ".component/simulator", ".view/Motors", ".view/simulator.component"}) {
      EXPECT_TRUE(answers(*process, name + rest)) << name + rest;
      EXPECT_FALSE(answers(*process, other + rest)) << other + rest;
    }
    for (const char* plain : {"Motors", "simulator/component", "robot.view/Motors", "robot/Motors"})
      EXPECT_FALSE(answers(*process, plain)) << plain;
  }
}

}  // namespace
}  // namespace vismem::test
