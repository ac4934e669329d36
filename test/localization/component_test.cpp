// The process localization against a visual memory over Ice (SPEC C2, C3).
#include <Ice/Ice.h>
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "active_visual_memory/ice/visual_memory_ice.h"
#include "common/geometry/angles.h"
#include "common/segment_map/segment_map.h"
#include "localization/corridor_world.h"
#include "localization/ice/localization_ice.h"
#include "support/component_process.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A visual memory on an ephemeral port, filled by a synthetic drive.
class MemoryServer {
 public:
  MemoryServer() : communicator_(Ice::initialize()) {
    adapter_ = communicator_->createObjectAdapterWithEndpoints("Memory", "tcp -h 127.0.0.1 -p 0");
    adapter_->add(std::make_shared<VisualMemoryServant>(memory_), Ice::stringToIdentity("VisualMemory"));
    adapter_->activate();
  }
  ~MemoryServer() {
    memory_.stop();
    adapter_->destroy();
  }
  std::string proxy() const { return "VisualMemory:" + adapter_->getPublishedEndpoints().at(0)->toString(); }
  MemoryBroadcaster& memory() { return memory_; }

 private:
  MemoryBroadcaster memory_;
  Ice::CommunicatorHolder communicator_;
  std::shared_ptr<Ice::ObjectAdapter> adapter_;
};

class LocalizationProcessTest : public testing::Test {
 protected:
  LocalizationProcessTest()
      : map_(std::filesystem::path(testing::TempDir()) / ("corridor_" + std::to_string(getpid()) + ".csv")) {
    saveSegmentMap(test::corridorMap(), map_);
  }
  ~LocalizationProcessTest() override { std::filesystem::remove(map_); }

  std::unique_ptr<ComponentProcess> process(const std::string& memory, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"--Localization.VisualMemory.Proxy=" + memory,
                                          "--Localization.Map=" + map_.string(),
                                          "--Localization.Endpoints=tcp -h 127.0.0.1 -p 0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<ComponentProcess>("localization", std::move(arguments));
  }
  std::shared_ptr<Ice::ObjectPrx> object(const std::string& identity, int port) {
    return communicator_->stringToProxy(identity + ":tcp -h 127.0.0.1 -p " + std::to_string(port))
        ->ice_invocationTimeout(5000);
  }

  const std::filesystem::path map_;
  Ice::CommunicatorHolder communicator_{Ice::initialize()};
};

TEST_F(LocalizationProcessTest, FindsTheRobotAndTakesCommands) {
  MemoryServer server;
  const auto child = process(server.proxy());
  ASSERT_GT(child->port(), 0) << child->error();
  RemoteLocalization localization(
      Ice::uncheckedCast<avm::LocalizationPrx>(object("Localization", child->port())));
  test::CorridorWorld world({}, 1);
  std::optional<PoseEstimate> estimate;
  std::uint64_t revision = 0;
  bool is_near = false;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!is_near && std::chrono::steady_clock::now() < deadline) {
    const MemoryUpdate update = world.next();
    server.memory().publish(update);
    // Lock-step: every update is answered before the next goes out.
    do {
      estimate = localization.next(revision, 1000ms);
      if (estimate) revision = estimate->revision;
    } while ((!estimate || estimate->stamp_us < update.snapshot->stamp_us) &&
             std::chrono::steady_clock::now() < deadline);
    ASSERT_TRUE(estimate) << child->error();
    EXPECT_EQ(estimate->stamp_us, update.snapshot->stamp_us);
    is_near = world.seconds() > 10.0 && estimate->T_world_robot &&
              (estimate->T_world_robot->position() - world.truth().position()).norm() < 0.3;
  }
  EXPECT_TRUE(is_near) << child->error();

  const Pose2 elsewhere{3.0, 0.0, 1.0};
  EXPECT_TRUE(localization.setPose(elsewhere).ok());
  estimate = localization.next(revision, 1000ms);
  ASSERT_TRUE(estimate && estimate->T_world_robot);
  EXPECT_EQ(*estimate->T_world_robot, elsewhere);
  EXPECT_EQ(estimate->reliability, 1.0);
  EXPECT_TRUE(localization.relocalize().ok());
  estimate = localization.next(estimate->revision, 1000ms);
  ASSERT_TRUE(estimate);
  EXPECT_FALSE(estimate->T_world_robot);
  EXPECT_FALSE(localization.setPose({std::nan(""), 0.0, 0.0}).ok());

  ASSERT_TRUE(child->signal(SIGTERM));
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
}

TEST_F(LocalizationProcessTest, ComesUpWithoutItsPeerAndSaysWhomItWaitsFor) {
  const auto child = process("VisualMemory:tcp -h 127.0.0.1 -p 1");
  ASSERT_GT(child->port(), 0) << child->error();
  EXPECT_TRUE(child->waitForLine("waiting for VisualMemory", kPatience)) << child->error();
  const auto component = Ice::checkedCast<avm::ComponentPrx>(object("localization/component", child->port()));
  ASSERT_TRUE(component);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  avm::ComponentStatus status = component->getStatus();
  while (status.peers.empty() && std::chrono::steady_clock::now() < deadline) status = component->getStatus();
  ASSERT_EQ(status.peers.size(), 1u);
  EXPECT_EQ(status.peers[0].name, "VisualMemory");
  ASSERT_TRUE(child->signal(SIGINT));
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
}

TEST_F(LocalizationProcessTest, RefusesABrokenMapByFileAndLine) {
  std::filesystem::path broken = map_;
  broken += ".broken";
  std::ofstream(broken) << "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n0,0,0,zero,0,0,skirting\n";
  const auto child = process("VisualMemory:tcp -h 127.0.0.1 -p 1", {"--Localization.Map=" + broken.string()});
  EXPECT_EQ(child->waitForExit(kPatience), 2);
  EXPECT_THAT(child->error(), HasSubstr(broken.string() + ":2"));
  std::filesystem::remove(broken);
}

TEST_F(LocalizationProcessTest, RefusesBadValuesAllAtOnce) {
  const auto child = process("VisualMemory:tcp -h 127.0.0.1 -p 1",
                             {"--Localization.Races.Maximum=0", "--Localization.Mood=good"});
  EXPECT_EQ(child->waitForExit(kPatience), 2);
  EXPECT_THAT(child->error(), HasSubstr("Localization.Races.Maximum = 0 (must be 1..64)"));
  EXPECT_THAT(child->error(), HasSubstr("Localization.Mood"));
}

}  // namespace
}  // namespace vismem
