// The whole robot under attack: garbage on every port, absurd calls of every operation, clients that never
// read. Required: no crash, no report of a sanitizer, constant memory, and service of well-behaved clients.
// All input comes from one seed.
#include <avm/camera.h>
#include <avm/component.h>
#include <avm/localization.h>
#include <avm/replay.h>
#include <avm/simulation.h>
#include <avm/visual_memory.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <iostream>
#include <set>
#include <thread>

#include "recording/bag_writer.h"
#include "support/build_paths.h"
#include "support/component_process.h"
#include "support/temporary_folder.h"
#include "untrusted_clients/attack.h"
#include "untrusted_clients/ice_wire.h"

namespace vismem::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

/// Absurd calls per component; the target for nightly runs makes many more.
constexpr long kCalls = VISMEM_ABSURD_CALLS;
constexpr long kGarbage = kCalls / 4;
constexpr std::uint64_t kSeed = 20'260'801;
/// Maximum wait of a well-behaved client: the long-poll's second, and a machine busy with the attack (and
/// with a sanitizer).
constexpr double kLongestAnswer_ms = 5000.0;
/// Memory that a process may have more at the end than after the first tenth of the attack.
constexpr double kGrowth_mb = 80.0;

struct ComponentUnderAttack {
  std::string name;
  std::vector<std::string> identities;
  std::unique_ptr<ComponentProcess> process;
  Target target;
  double resident_mb = 0.0;  ///< after the first tenth
};

class UntrustedClients : public testing::Test {
 protected:
  UntrustedClients()
      : model_(readSlice(VISMEM_SOURCE_DIR "/interfaces")), communicator_(Ice::initialize(politeSettings())) {
    bag_ = std::filesystem::path(testing::TempDir()) /
           ("untrusted_clients_" + std::to_string(getpid()) + ".bag");
    writeBag(bag_.string());
  }
  ~UntrustedClients() override { std::filesystem::remove(bag_); }

  static Ice::InitializationData politeSettings() {
    Ice::InitializationData data;
    data.properties = Ice::createProperties();
    data.properties->setProperty("Ice.MessageSizeMax", "16384");
    data.properties->setProperty("Ice.Default.InvocationTimeout", "20000");
    return data;
  }

  static void writeBag(const std::string& file) {
    BagWriter bag(file);
    bag.cameraInfo("/camera/camera_info", 1'000'000, 32, 24, 20.0);
    for (int i = 0; i < 20; ++i) {
      const std::int64_t stamp_us = 1'000'000 + 50'000 * i;
      bag.image("/camera/image_raw", stamp_us, "mono8", 32, 24, std::vector<std::uint8_t>(32 * 24, 7));
      bag.odometry("/odom", stamp_us - 20'000, 0.1 * i, 0.0, 0.0);
      bag.joints("/joint_states", stamp_us - 30'000, {"head_yaw", "head_pitch"}, {0.01 * i, 0.2});
    }
    bag.close();
  }

  ComponentUnderAttack& start(const std::string& name, const std::string& prefix,
                              std::vector<std::string> arguments, std::vector<std::string> identities) {
    arguments.push_back("--" + prefix + ".Endpoints=tcp -h 127.0.0.1 -p 0");
    arguments.push_back("--" + prefix + ".WebEndpoints=ws -h 127.0.0.1 -p 0");
    arguments.push_back("--Robot.Token=0123456789abcdef");
    ChildProcess::Options options;
    options.working_directory = VISMEM_SOURCE_DIR;
    // The sanitizer's store of freed memory must not be taken for growth.
    options.environment = {{"ASAN_OPTIONS", "quarantine_size_mb=8"}};
    ComponentUnderAttack component;
    component.name = name;
    component.process = std::make_unique<ComponentProcess>(name, arguments, options);
    identities.push_back(name + "/component");
    component.identities = identities;
    components_.push_back(std::move(component));
    return components_.back();
  }

  void aim(ComponentUnderAttack& component) {
    ASSERT_TRUE(component.process->waitUntilReady());
    component.target = {component.name, component.process->port("tcp"), component.process->port("ws"), {}};
    for (const auto& identity : component.identities) {
      const auto object = communicator_->stringToProxy(component.process->proxy(identity));
      // The most derived of its interfaces is the one with the most operations.
      const SliceInterface* widest = nullptr;
      for (const auto& id : object->ice_ids()) {
        const auto found = model_.interfaces.find(id);
        if (found == model_.interfaces.end()) continue;
        if (widest == nullptr || found->second.operations.size() > widest->operations.size())
          widest = &found->second;
      }
      ASSERT_NE(widest, nullptr) << identity;
      component.target.objects[identity] = widest;
    }
  }

  template <typename Prx>
  std::shared_ptr<Prx> find(const std::string& component, const std::string& identity) {
    for (const auto& candidate : components_) {
      if (candidate.name == component)
        return Ice::uncheckedCast<Prx>(communicator_->stringToProxy(candidate.process->proxy(identity)));
    }
    throw std::logic_error("no component " + component);
  }

  std::filesystem::path bag_;
  const SliceModel model_;
  Ice::CommunicatorHolder communicator_;
  std::vector<ComponentUnderAttack> components_;
};

TEST_F(UntrustedClients, TheRobotGoesOn) {
  components_.reserve(9);
  auto& simulator = start("simulator", "Simulator", {"cfg/sim/simulator.cfg"},
                          {"cameraA", "PanTilt", "Motors", "Encoders", "Simulation"});
  aim(simulator);
  auto& replay =
      start("replay_server", "ReplayServer",
            {"--ReplayServer.File=" + bag_.string(), "--ReplayServer.Loop=yes", "--ReplayServer.Start=now"},
            {"cameraA", "PanTilt", "Motors", "Encoders", "Replay"});
  aim(replay);
  aim(start("camera_server", "CameraServer", {"cfg/files/camera_server.cfg"}, {"cameraA"}));
  aim(start("pantilt_server", "PanTiltServer", {"cfg/files/pantilt_server.cfg"}, {"PanTilt"}));
  aim(start("base_server", "BaseServer", {"cfg/files/base_server.cfg"}, {"Motors", "Encoders"}));
  auto& memory = start("active_visual_memory", "ActiveVisualMemory",
                       {"cfg/sim/active_visual_memory.cfg",
                        "--ActiveVisualMemory.Camera.Proxy=" + simulator.process->proxy("cameraA"),
                        "--ActiveVisualMemory.PanTilt.Proxy=" + simulator.process->proxy("PanTilt"),
                        "--ActiveVisualMemory.Odometry.Proxy=" + simulator.process->proxy("Encoders")},
                       {"VisualMemory", "Gaze", "memoryView"});
  aim(memory);
  auto& localization = start("localization", "Localization",
                             {"cfg/sim/localization.cfg",
                              "--Localization.VisualMemory.Proxy=" + memory.process->proxy("VisualMemory")},
                             {"Localization"});
  aim(localization);
  const TemporaryFolder recordings;
  aim(start("recorder", "Recorder",
            {"--Recorder.Folder=" + recordings.path().string(), "--Recorder.StartNow=no",
             "--Recorder.Odometry.Proxy=" + simulator.process->proxy("Encoders")},
            {"Recorder"}));
  const TemporaryFolder maps;
  aim(start("mapper", "Mapper",
            {"cfg/sim/mapper.cfg", "--Mapper.Folder=" + maps.path().string(),
             "--Mapper.VisualMemory.Proxy=" + memory.process->proxy("VisualMemory"),
             "--Mapper.Camera.Proxy=" + simulator.process->proxy("cameraA")},
            {"Mapper"}));

  // Untrusted clients may pause and speed up what can be paused and sped up: the owner sets it right again
  // and again.
  const auto simulation = find<avm::SimulationPrx>("simulator", "Simulation");
  const auto replay_control = find<avm::ReplayPrx>("replay_server", "Replay");
  const auto camera = find<avm::CameraPrx>("simulator", "cameraA");
  const auto visual_memory = find<avm::VisualMemoryPrx>("active_visual_memory", "VisualMemory");
  std::atomic<long> images = 0;
  std::atomic<long> updates = 0;
  // Last, so that they end before what they use.
  std::vector<std::unique_ptr<PoliteClient>> polite;
  const auto add = [&](const std::string& name, std::function<void()> ask) {
    polite.push_back(std::make_unique<PoliteClient>(name, std::move(ask)));
  };
  add("owner", [&] {
    simulation->setPaused(false);
    simulation->setSpeed(1.0);
    replay_control->setPaused(false);
    replay_control->setRate(1.0);
    replay_control->setLoop(true);
  });
  add("images", [&, last = Ice::Long{-1}]() mutable {
    const auto result = camera->getNext("RGB8", last);
    if (result.state != avm::SourceState::Running) return;
    last = result.image.seq;
    if (result.image.pixels.size() != 320u * 240u * 3u) throw std::runtime_error("a cut image");
    ++images;
  });
  add("memory", [&, last = Ice::Long{0}]() mutable {
    const auto result = visual_memory->next(last);
    if (result.state != avm::SourceState::Running) return;
    last = result.update.snapshot.revision;
    ++updates;
  });
  for (const auto& component : components_) {
    add(component.name + " status",
        [status = find<avm::ComponentPrx>(component.name, component.name + "/component")] {
          if (status->getStatus().name.empty()) throw std::runtime_error("a status without a name");
        });
  }

  std::vector<RawConnection> standing;
  for (const auto& component : components_) {
    for (auto& connection : leaveStanding(component.target, 40)) standing.push_back(std::move(connection));
  }
  const auto begin = std::chrono::steady_clock::now();
  std::atomic<long> calls = 0;
  std::atomic<long> deliveries = 0;
  {
    std::vector<std::jthread> attackers;
    std::uint64_t seed = kSeed;
    for (auto& component : components_) {
      attackers.emplace_back([&, seed = ++seed] {
        AbsurdCaller caller(model_, component.target, seed);
        EXPECT_TRUE(caller.call(kCalls / 10)) << component.name << " answers no more";
        component.resident_mb = residentMb(component.process->pid());
        EXPECT_TRUE(caller.call(kCalls - kCalls / 10)) << component.name << " answers no more:\n"
                                                       << component.process->error();
        for (const auto& [identity, interface] : component.target.objects) {
          for (const auto& operation : interface->operations) {
            EXPECT_TRUE(caller.perOperation().contains(identity + " " + operation.name)) << "never called";
          }
        }
        EXPECT_GT(caller.replies(), caller.calls() / 2);
        calls += caller.calls();
      });
      attackers.emplace_back([&, seed = seed + 1000] {
        const long made = sendGarbage(component.target, kGarbage, seed);
        EXPECT_EQ(made, kGarbage) << component.name << " takes no more connections";
        deliveries += made;
      });
    }
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;

  for (const auto& component : components_) {
    ASSERT_TRUE(component.process->running())
        << component.name << " ended with " << *component.process->exitCode() << ":\n"
        << component.process->error();
  }
  // Those who were served before are served afterwards, too.
  const long images_before = images;
  EXPECT_TRUE(camera->getNext("RGB8", -1).state == avm::SourceState::Running);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (images == images_before && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_GT(images, images_before);
  EXPECT_GT(images, static_cast<long>(took.count())) << "images came less than once a second";
  for (auto& client : polite) client->stop();

  std::cout << calls << " absurd calls and " << deliveries << " deliveries of garbage in " << took.count()
            << " s (seed " << kSeed << "); meanwhile " << images << " images, " << updates
            << " updates of the memory\n";
  for (const auto& client : polite) {
    const auto figures = client->figures();
    std::printf("  %-28s %6zu answers, p50 %7.1f ms, p99 %7.1f ms, max %7.1f ms\n", figures.name.c_str(),
                figures.answers, figures.p50_ms, figures.p99_ms, figures.max_ms);
    EXPECT_EQ(figures.failures, std::vector<std::string>{}) << figures.name;
    EXPECT_GT(figures.answers, 2u) << figures.name;
    EXPECT_LT(figures.max_ms, kLongestAnswer_ms) << figures.name;
  }
  for (auto& component : components_) {
    const double now_mb = residentMb(component.process->pid());
    std::printf("  %-28s %.0f MB after the first tenth, %.0f MB at the end\n", component.name.c_str(),
                component.resident_mb, now_mb);
    EXPECT_LT(now_mb, component.resident_mb + kGrowth_mb) << component.name;
  }
  standing.clear();
  for (auto it = components_.rbegin(); it != components_.rend(); ++it) {
    EXPECT_EQ(it->process->stop(kPatience), 0) << it->name << ":\n" << it->process->error();
    const std::string log = it->process->error();
    EXPECT_THAT(log, Not(HasSubstr("Sanitizer"))) << it->name;
    EXPECT_THAT(log, Not(HasSubstr("runtime error:"))) << it->name;
    EXPECT_LT(it->process->lineCount(), 5000u) << it->name << " lets untrusted clients fill its log";
  }
}

TEST_F(UntrustedClients, AClientThatNeverReadsCostsNoMemory) {
  components_.reserve(1);
  auto& simulator = start("simulator", "Simulator", {"cfg/sim/simulator.cfg"}, {"cameraA"});
  aim(simulator);
  const auto camera = find<avm::CameraPrx>("simulator", "cameraA");
  camera->getNext("RGB8", -1);
  camera->getImageData("RGB8");
  const double before_mb = residentMb(simulator.process->pid());
  RawConnection greedy(simulator.target.tcp_port);
  ASSERT_TRUE(greedy.receive());
  Call call{1, "cameraA", "", "", "getImageData", true, WireBytes().text("RGB8").take()};
  // 3000 images of 230 kB would be 690 MB.
  for (int i = 1; i <= 3000 && greedy.open(); ++i) {
    call.id = i;
    greedy.send(request(call), 5s);
  }
  double most_mb = 0.0;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(camera->getNext("RGB8", -1).state, avm::SourceState::Running);
    most_mb = std::max(most_mb, residentMb(simulator.process->pid()));
  }
  EXPECT_TRUE(simulator.process->waitForLine("does not take its answers", kPatience))
      << simulator.process->error();
  EXPECT_LT(std::max(most_mb, residentMb(simulator.process->pid())), before_mb + 150.0);
  EXPECT_EQ(simulator.process->stop(kPatience), 0) << simulator.process->error();
}

TEST_F(UntrustedClients, ASequenceThatIsNotThereIsNotAllocated) {
  components_.reserve(1);
  auto& simulator = start("simulator", "Simulator", {"cfg/sim/simulator.cfg"}, {"Simulation"});
  aim(simulator);
  RawConnection client(simulator.target.tcp_port);
  ASSERT_TRUE(client.receive());
  const double before_mb = peakMb(simulator.process->pid());
  // So many points of 16 bytes that 32 bits overflow: to 0, and to little less than 0.
  for (const std::int64_t points : {std::int64_t{1} << 28, (std::int64_t{1} << 31) - 1}) {
    WireBytes parameters;
    parameters.text("visitor").size(points).number(1.0).number(2.0).byte(0).byte(0).number(0.5);
    const Call call{7, "Simulation", "", "", "walkModel", false, parameters.take()};
    ASSERT_TRUE(client.send(request(call)));
    const auto answer = client.receive();
    ASSERT_TRUE(answer);
    EXPECT_NE(answer->at(kHeaderSize + 4), 0) << "a call of which most is missing was carried out";
  }
  EXPECT_LT(peakMb(simulator.process->pid()), before_mb + 100.0);
  EXPECT_EQ(simulator.process->stop(kPatience), 0) << simulator.process->error();
}

TEST_F(UntrustedClients, ThousandsOfConnectionsDoNotShutOthersOut) {
  components_.reserve(1);
  auto& simulator = start("simulator", "Simulator", {"cfg/sim/simulator.cfg"}, {"cameraA"});
  aim(simulator);
  // This side needs as many descriptors.
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  limit.rlim_cur = limit.rlim_max;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  if (limit.rlim_max < 4096) GTEST_SKIP() << "only " << limit.rlim_max << " descriptors are allowed here";
  const auto standing = leaveStanding(simulator.target, 1500);
  EXPECT_TRUE(standing.back().open());
  const Ice::CommunicatorHolder newcomer(Ice::initialize(politeSettings()));
  const auto camera =
      Ice::uncheckedCast<avm::CameraPrx>(newcomer->stringToProxy(simulator.process->proxy("cameraA")));
  EXPECT_EQ(camera->getNext("RGB8", -1).state, avm::SourceState::Running);
  EXPECT_EQ(simulator.process->stop(kPatience), 0) << simulator.process->error();
}

}  // namespace
}  // namespace vismem::test
