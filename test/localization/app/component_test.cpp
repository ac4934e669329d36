// Tests C2, C3: the process against a visual memory over Ice.
#include <Ice/Ice.h>
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <set>

#include "common/geometry/angles.h"
#include "common/memory_ice/gaze_ice.h"
#include "common/memory_ice/visual_memory_ice.h"
#include "common/segment_map/segment_map.h"
#include "localization/corridor_world.h"
#include "localization/ice/localization_ice.h"
#include "robot_ice/loopback.h"
#include "support/component_process.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Records the requests of clients.
class FakeGaze : public GazeClient {
 public:
  PortReply setMode(GazeMode) override { return PortReply::accepted(); }
  PortReply fixate(const Eigen::Vector3d&) override { return PortReply::accepted(); }
  PortReply request(const GazeRequest& request) override {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
    return PortReply::accepted();
  }
  PortReply withdraw(const std::string&, const std::string& key) override {
    const std::lock_guard lock(mutex_);
    withdrawn_.push_back(key);
    return PortReply::accepted();
  }
  std::optional<GazeStatus> status() override { return std::nullopt; }

  std::vector<GazeRequest> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  std::vector<std::string> withdrawn() const {
    const std::lock_guard lock(mutex_);
    return withdrawn_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<GazeRequest> requests_;
  std::vector<std::string> withdrawn_;
};

/// A gaze that can disappear and return at its port.
class GazeServer {
 public:
  explicit GazeServer(FakeGaze& gaze, int port = 0) : server_(port) {
    server_.add("Gaze", std::make_shared<GazeServant>(gaze, gaze_statuses));
    server_.activate();
  }
  int port() const { return server_.port(); }
  std::string proxy() const { return "Gaze:tcp -h 127.0.0.1 -p " + std::to_string(port()); }

 private:
  GazeBroadcaster gaze_statuses;
  LoopbackServer server_;
};

/// A visual memory on an ephemeral port, filled by a synthetic drive.
class MemoryServer {
 public:
  MemoryServer() : communicator_(Ice::initialize()) {
    adapter_ = communicator_->createObjectAdapterWithEndpoints("Memory", "tcp -h 127.0.0.1 -p 0");
    adapter_->add(std::make_shared<VisualMemoryServant>(memory_, [] { return PortReply::accepted(); }),
                  Ice::stringToIdentity("VisualMemory"));
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

  /// Lock-step until the world's time: every update is answered before the next goes out.
  static void drive(test::CorridorWorld& world, MemoryServer& server, RemoteLocalization& localization,
                    double until_s) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (world.seconds() < until_s) {
      const MemoryUpdate update = world.next();
      server.memory().publish(update);
      std::optional<PoseEstimate> estimate;
      while (!estimate || estimate->stamp_us < update.snapshot->stamp_us) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        estimate = localization.next(estimate ? estimate->revision : 0, 1000ms);
      }
    }
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
  EXPECT_LT(estimate->reliability, 0.3) << "the observation contradicts the given pose";
  EXPECT_TRUE(localization.relocalize().ok());
  estimate = localization.next(estimate->revision, 1000ms);
  ASSERT_TRUE(estimate);
  EXPECT_FALSE(estimate->T_world_robot);
  EXPECT_FALSE(localization.setPose({std::nan(""), 0.0, 0.0}).ok());

  ASSERT_TRUE(child->signal(SIGTERM));
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
}

TEST_F(LocalizationProcessTest, ComputesHealthMapsBesideTheLoop) {
  MemoryServer server;
  const auto child = process(server.proxy());
  ASSERT_GT(child->port(), 0) << child->error();
  RemoteLocalization localization(
      Ice::uncheckedCast<avm::LocalizationPrx>(object("Localization", child->port())));
  HealthMapRequest request;
  request.rating = PlaceRating::kMemory;
  request.cell_m = 0.5;
  request.headings = 12;
  EXPECT_THAT(localization.healthMap(request).why, HasSubstr("no observation yet"));

  test::CorridorWorld world({}, 1);
  drive(world, server, localization, 8.0);
  const Pose2 truth = world.truth();
  const auto coarse = localization.healthMap(request);
  ASSERT_TRUE(coarse.map) << coarse.why;
  EXPECT_EQ(coarse.map->stamp_us, localization.latest()->stamp_us);
  EXPECT_GT(coarse.map->columns, 10);
  // The true pose fits better than most of the map.
  request.theta_rad = truth.theta;
  request.low = truth.position();
  request.high = truth.position();
  const auto there = localization.healthMap(request);
  ASSERT_TRUE(there.map) << there.why;
  ASSERT_EQ(there.map->health.size(), 1U);
  EXPECT_GT(there.map->health[0], 0.7);
  std::vector<float> all = coarse.map->health;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  EXPECT_GT(there.map->health[0], all[all.size() / 2] + 0.2);

  request = {};
  request.cell_m = -1.0;
  EXPECT_THAT(localization.healthMap(request).why, HasSubstr("cell_m = -1 (must be > 0)"));
  request.cell_m = 1e-3;
  EXPECT_THAT(localization.healthMap(request).why, HasSubstr("makes more than 120000 places"));

  // A map of the largest size takes seconds: meanwhile images are answered, and a stop does not wait.
  request = {};
  request.cell_m = 0.05;
  request.headings = 100;
  auto slow = std::async(std::launch::async, [&] { return localization.healthMap(request); });
  RemoteLocalization other(Ice::uncheckedCast<avm::LocalizationPrx>(object("Localization", child->port())));
  const double begin_s = world.seconds();
  do {
    drive(world, server, other, world.seconds() + 0.5);
  } while (slow.wait_for(0ms) == std::future_status::timeout && world.seconds() < begin_s + 5.0);
  ASSERT_TRUE(child->signal(SIGTERM));
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
  const auto result = slow.get();
  if (!result.map) {
    EXPECT_THAT(result.why, HasSubstr("localization stops"));
  }
}

TEST_F(LocalizationProcessTest, RequestsGazeUntilThePoseIsCertain) {
  MemoryServer server;
  FakeGaze gaze;
  GazeServer gaze_server(gaze);
  const auto child = process(server.proxy(), {"--Localization.Gaze.Proxy=" + gaze_server.proxy()});
  ASSERT_GT(child->port(), 0) << child->error();
  RemoteLocalization localization(
      Ice::uncheckedCast<avm::LocalizationPrx>(object("Localization", child->port())));
  // Nearly perfect odometry: a certain pose stays certain.
  test::CorridorParams smooth;
  smooth.odometry_scale_error = 0.01;
  smooth.odometry_turn_noise = 0.005;
  test::CorridorWorld world(smooth, 1);
  drive(world, server, localization, 1.0);
  // At an unknown pose it requests a place, with its name and a deadline.
  EXPECT_TRUE(eventually([&] { return !gaze.requests().empty(); })) << child->error();
  ASSERT_FALSE(gaze.requests().empty());
  const GazeRequest first = gaze.requests().front();
  EXPECT_EQ(first.client, "localization");
  EXPECT_TRUE(first.p_odom);
  EXPECT_GT(first.priority, 50.0);
  EXPECT_NEAR(toSeconds(first.deadline_us), 2.0, 1.1);
  // A certain pose requests nothing.
  drive(world, server, localization, 40.0);
  const auto estimate = localization.latest();
  ASSERT_TRUE(estimate && estimate->T_world_robot);
  EXPECT_LT((estimate->T_world_robot->position() - world.truth().position()).norm(), 0.3);
  const std::size_t asked = gaze.requests().size();
  drive(world, server, localization, 44.0);
  EXPECT_LE(gaze.requests().size(), asked + 1);
  // All requests were withdrawn or reached their deadline. A request that moves keeps its key.
  std::set<std::string> keys;
  for (const GazeRequest& request : gaze.requests()) keys.insert(request.key);
  for (const std::string& key : gaze.withdrawn()) EXPECT_EQ(keys.erase(key), 1u) << key;
  EXPECT_LE(keys.size(), 1u);
  const auto status =
      Ice::checkedCast<avm::ComponentPrx>(object("localization/component", child->port()))->getStatus();
  ASSERT_EQ(status.peers.size(), 2u);
  const auto rate = std::find_if(status.rates.begin(), status.rates.end(),
                                 [](const auto& one) { return one.name == "gaze requests"; });
  ASSERT_NE(rate, status.rates.end());
  EXPECT_EQ(static_cast<std::size_t>(rate->total), gaze.requests().size());
  ASSERT_TRUE(child->signal(SIGTERM));
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
}

TEST_F(LocalizationProcessTest, SurvivesTheLossOfTheGazeAndFindsItAgain) {
  MemoryServer server;
  FakeGaze gaze;
  // A free port of the system's choice: the child must not inherit the socket of a server that ends.
  const int port = GazeServer(gaze).port();
  const auto child =
      process(server.proxy(), {"--Localization.Gaze.Proxy=Gaze:tcp -h 127.0.0.1 -p " + std::to_string(port)});
  ASSERT_GT(child->port(), 0) << child->error();
  auto gaze_server = std::make_unique<GazeServer>(gaze, port);
  RemoteLocalization localization(
      Ice::uncheckedCast<avm::LocalizationPrx>(object("Localization", child->port())));
  test::CorridorWorld world({}, 1);
  drive(world, server, localization, 1.0);
  EXPECT_TRUE(eventually([&] { return !gaze.requests().empty(); })) << child->error();
  gaze_server.reset();
  EXPECT_TRUE(localization.relocalize().ok());
  drive(world, server, localization, 4.0);  // poses continue
  const auto component = Ice::checkedCast<avm::ComponentPrx>(object("localization/component", child->port()));
  EXPECT_TRUE(eventually([&] {
    const auto status = component->getStatus();
    return status.state == avm::ComponentState::Degraded && status.reason.find("Gaze") != std::string::npos;
  })) << component->getStatus().reason;
  const std::size_t asked = gaze.requests().size();
  gaze_server = std::make_unique<GazeServer>(gaze, port);
  EXPECT_TRUE(localization.relocalize().ok());
  EXPECT_TRUE(eventually([&] {
    drive(world, server, localization, world.seconds() + 0.5);
    localization.relocalize();
    return gaze.requests().size() > asked;
  })) << child->error();
  EXPECT_TRUE(child->waitForLine("Gaze is back", kPatience)) << child->error();
}

TEST_F(LocalizationProcessTest, TakesAnEditedMapWithoutARestart) {
  MemoryServer server;
  const auto child = process(server.proxy());
  ASSERT_GT(child->port(), 0) << child->error();
  const auto proxy = Ice::uncheckedCast<avm::LocalizationPrx>(object("Localization", child->port()));
  RemoteLocalization localization(proxy);
  test::CorridorWorld world({}, 1);
  drive(world, server, localization, 2.0);
  const std::string first = proxy->getMap().id;
  // A broken map changes nothing.
  std::ofstream(map_) << "x1_m,y1_m\n";
  const auto component = Ice::checkedCast<avm::ComponentPrx>(object("localization/component", child->port()));
  EXPECT_TRUE(eventually([&] {
    return component->getStatus().reason.find("cannot be used, the last one stays") != std::string::npos;
  })) << component->getStatus().reason;
  EXPECT_EQ(proxy->getMap().id, first);
  drive(world, server, localization, 3.0);
  // The whole place is drawn 10 m further on.
  const Eigen::Vector3d shift(10.0, 0.0, 0.0);
  SegmentMap moved = test::corridorMap();
  for (MapSegment& segment : moved.segments) {
    segment.world.a += shift;
    segment.world.b += shift;
  }
  saveSegmentMap(moved, map_);
  EXPECT_TRUE(child->waitForLine("has changed: localizing with it", kPatience)) << child->error();
  EXPECT_TRUE(eventually([&] { return proxy->getMap().id != first; }));
  EXPECT_TRUE(localization.relocalize().ok());
  drive(world, server, localization, 18.0);
  const auto estimate = localization.latest();
  ASSERT_TRUE(estimate && estimate->T_world_robot);
  EXPECT_LT((estimate->T_world_robot->position() - world.truth().position() - shift.head<2>()).norm(), 0.3);
  EXPECT_TRUE(eventually([&] { return component->getStatus().reason.empty(); }))
      << component->getStatus().reason;
}

TEST_F(LocalizationProcessTest, ReportsThatItRequestsNoGaze) {
  MemoryServer server;
  const auto child = process(server.proxy());
  ASSERT_GT(child->port(), 0) << child->error();
  EXPECT_TRUE(child->waitForLine("requests no gaze: Localization.Gaze.Proxy is not set", kPatience))
      << child->error();
}

TEST_F(LocalizationProcessTest, StartsWithoutItsPeerAndReportsIt) {
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
