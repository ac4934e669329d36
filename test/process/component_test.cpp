// The life of a component's process: a real program: start, status over Ice, stop.
// Tests C2, C3.
#include <Ice/Ice.h>
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>

#include "support/component_process.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

class ComponentTest : public testing::Test {
 protected:
  ComponentTest()
      : folder_(std::filesystem::path(testing::TempDir()) / ("component_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ComponentTest() override { std::filesystem::remove_all(folder_); }

  std::string config(const std::string& text) {
    const auto file = (folder_ / "probe.cfg").string();
    std::ofstream(file) << text;
    return file;
  }
  static std::unique_ptr<ComponentProcess> probe(std::vector<std::string> arguments,
                                                 ChildProcess::Options options = {}) {
    return std::make_unique<ComponentProcess>("probe_component", std::move(arguments), std::move(options));
  }
  avm::ComponentStatus statusAt(int port) {
    const auto proxy =
        communicator_->stringToProxy("probe_component/component:tcp -h 127.0.0.1 -p " + std::to_string(port));
    return Ice::checkedCast<avm::ComponentPrx>(proxy->ice_invocationTimeout(5000))->getStatus();
  }
  /// Asks until the status is as wanted.
  /// @return the last one.
  template <typename Wanted>
  avm::ComponentStatus waitForStatus(int port, Wanted&& wanted) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    auto status = statusAt(port);
    while (!wanted(status) && std::chrono::steady_clock::now() < deadline) status = statusAt(port);
    return status;
  }

  const std::filesystem::path folder_;
  Ice::CommunicatorHolder communicator_{Ice::initialize()};
};

TEST_F(ComponentTest, SaysReadyWithItsRealPortAndEndsCleanlyOnSignals) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const auto child = probe({"--Ice.Config=" + config("Probe.Size = 3\n")});
    ASSERT_GT(child->port(), 0) << child->error();
    ASSERT_TRUE(child->signal(signal));
    EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
    EXPECT_THAT(child->out(),
                MatchesRegex("probe_component ready: ProbeAdapter=tcp -h 127\\.0\\.0\\.1 -p [0-9]+\n"))
        << "exactly one line on stdout";
    EXPECT_THAT(child->error(), HasSubstr("stopping: signal " + std::to_string(signal)));
  }
}

TEST_F(ComponentTest, SaysLoudlyThatOtherMachinesReachIt) {
  const auto open = probe({"--Probe.Endpoints=tcp -h 0.0.0.0 -p 0", "--Probe.PlainRemote=yes"});
  ASSERT_GT(open->port(), 0) << open->error();
  const auto status = statusAt(open->port());
  ASSERT_EQ(status.errors.size(), 1U);
  EXPECT_THAT(status.errors[0].text, testing::StartsWith("open to other machines: tcp -h 0.0.0.0 -p "));
  EXPECT_THAT(open->error(), HasSubstr("ERROR open to other machines: tcp -h 0.0.0.0 -p "));
  const auto closed = probe({});
  ASSERT_GT(closed->port(), 0) << closed->error();
  EXPECT_TRUE(statusAt(closed->port()).errors.empty());
  EXPECT_THAT(closed->error(), Not(HasSubstr("other machines")));
}

TEST_F(ComponentTest, ReadyLineGivesThePortOfEachEndpoint) {
  const auto child = probe({"--Probe.Endpoints=tcp -h 127.0.0.1 -p 0:tcp -h 127.0.0.1 -p 0",
                            "--Probe.WebEndpoints=ws -h 127.0.0.1 -p 0", "--Robot.Token=0123456789abcdef"});
  ASSERT_TRUE(child->waitUntilReady());
  const auto line = child->readyLine();
  EXPECT_THAT(*line, MatchesRegex("probe_component ready: ProbeAdapter=tcp -h 127\\.0\\.0\\.1 -p [0-9]+:"
                                  "tcp -h 127\\.0\\.0\\.1 -p [0-9]+ "
                                  "ProbeWebAdapter=ws -h 127\\.0\\.0\\.1 -p [0-9]+"));
  EXPECT_EQ(statusAt(child->port("tcp")).name, "probe_component");
  EXPECT_GT(child->port("ws"), 0);
}

TEST_F(ComponentTest, TakesTheFileBareOrFromTheEnvironment) {
  const auto file = config("Probe.Size = 0\n");
  const auto message = file + ":1: Probe.Size = 0 (must be 1..64)\n";
  const auto bare = probe({file});
  EXPECT_EQ(bare->waitForExit(kPatience), 2);
  EXPECT_EQ(bare->error(), message);
  ChildProcess::Options options;
  options.environment = {{"ICE_CONFIG", file}};
  const auto environment = probe({}, options);
  EXPECT_EQ(environment->waitForExit(kPatience), 2);
  EXPECT_EQ(environment->error(), message);
}

TEST_F(ComponentTest, ReportsEverythingWrongWithTheConfigurationAndNothingElse) {
  const auto file = config(
      "Probe.Sise = 3\n"
      "Probe.Work = dance\n"
      "Probe.Work = serve\n"
      "rubbish\n"
      "Ice.MesageSizeMax = 4\n"
      "Prob.Size = 4\n"
      "Probe.BadMap = yes\n");
  const auto child = probe({"--Ice.Config=" + file, "--Probe.LogLevel=loud", "--what"});
  EXPECT_EQ(child->waitForExit(kPatience), 2);
  EXPECT_EQ(child->error(),
            file + ":1: unknown key \"Probe.Sise\" (did you mean \"Probe.Size\"?)\n" +  //
                file +
                ":2: Probe.Work = dance (must be one of: serve, finish, fail_to_start, fail, fail_slowly, "
                "throw, hang, hang_on_stop)\n" +
                file + ":3: key \"Probe.Work\" is set twice (first in line 2)\n" +  //
                file + ":4: \"rubbish\" (must be KEY = VALUE)\n" + file +
                ":5: unknown key \"Ice.MesageSizeMax\" (did you mean \"Ice.MessageSizeMax\"?)\n" + file +
                ":6: unknown key \"Prob.Size\" (did you mean \"Probe.Size\"?)\n" +
                "command line: \"--what\" (must be --Key=Value)\n" +
                "command line: Probe.LogLevel = loud (must be one of: debug, info, warning, error)\n" +
                "map.csv:7: label = 3 (must be a name)\n");
  EXPECT_EQ(child->out(), "");
}

TEST_F(ComponentTest, MissingFile) {
  const auto child = probe({"--Ice.Config=no/such.cfg"});
  EXPECT_EQ(child->waitForExit(kPatience), 2);
  EXPECT_EQ(child->error(),
            "no/such.cfg: cannot be read (No such file or directory; must be a configuration of lines KEY = "
            "VALUE)\n");
}

TEST_F(ComponentTest, MalformedProxyAndEndpointsNameTheirKeys) {
  const auto file = config("\nProbe.Peer.Proxy = cameraA:tcp -q 3\n");
  const auto proxy = probe({file});
  EXPECT_EQ(proxy->waitForExit(kPatience), 2);
  EXPECT_THAT(
      proxy->error(),
      HasSubstr(file + ":2: Probe.Peer.Proxy = cameraA:tcp -q 3 (must be a proxy such as cameraA:tcp -h "
                       "127.0.0.1 -p 9999: "));
  const auto endpoints = probe({"--Probe.Endpoints=carrier pigeon"});
  EXPECT_EQ(endpoints->waitForExit(kPatience), 2);
  EXPECT_THAT(endpoints->error(),
              HasSubstr("command line: Probe.Endpoints = carrier pigeon (must be endpoints such "
                        "as tcp -h 127.0.0.1 -p 9999: "));
}

TEST_F(ComponentTest, PortInUse) {
  const auto first = probe({});
  const int port = first->port();
  ASSERT_GT(port, 0) << first->error();
  const auto endpoint = "tcp -h 127.0.0.1 -p " + std::to_string(port);
  const auto second = probe({"--Probe.Endpoints=" + endpoint});
  EXPECT_EQ(second->waitForExit(kPatience), 1);
  EXPECT_EQ(second->out(), "");
  EXPECT_THAT(second->error(), HasSubstr("ERROR cannot serve at Probe.Endpoints = " + endpoint +
                                         " (adapter ProbeAdapter): Address already in use\n"));
  EXPECT_TRUE(first->running());
}

TEST_F(ComponentTest, AFailureEndsWithItsMessage) {
  const auto start = probe({"--Probe.Work=fail_to_start"});
  EXPECT_EQ(start->waitForExit(kPatience), 1);
  EXPECT_EQ(start->out(), "") << "never ready";
  EXPECT_THAT(start->error(), HasSubstr("ERROR the device does not open\n"));
  const auto loop = probe({"--Probe.Work=fail"});
  EXPECT_EQ(loop->waitForExit(kPatience), 1);
  EXPECT_THAT(loop->error(), HasSubstr("ERROR the loop has failed\n"));
}

TEST_F(ComponentTest, AThreadThatThrowsEndsTheProcessLoudly) {
  const auto child = probe({"--Probe.Work=throw"});
  EXPECT_EQ(child->waitForExit(kPatience), 1);
  EXPECT_THAT(child->error(), HasSubstr("ERROR the thread has thrown\n"));
}

TEST_F(ComponentTest, AThreadThatHangsShowsInTheStatus) {
  const auto child = probe({"--Probe.Work=hang"});
  const int port = child->port();
  ASSERT_GT(port, 0) << child->error();
  EXPECT_TRUE(child->waitForLine("ERROR loop: no progress for ", kPatience)) << child->error();
  const auto status = statusAt(port);
  EXPECT_EQ(status.state, avm::ComponentState::Degraded);
  EXPECT_THAT(status.reason, HasSubstr("loop: no progress for "));
  EXPECT_EQ(child->stop(kPatience), 0);
}

TEST_F(ComponentTest, EndsInTimeThoughItsOwnStopHangs) {
  const auto child = probe({"--Probe.Work=hang_on_stop"});
  ASSERT_TRUE(child->waitUntilReady());
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(child->signal(SIGTERM));
  EXPECT_EQ(child->waitForExit(3 * kPatience), 1);
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 3s);
  EXPECT_THAT(child->error(), HasSubstr("probe_component ERROR did not stop within "));
}

TEST_F(ComponentTest, ASignalWhileItEndsForAnotherReasonLosesNothing) {
  const auto child = probe({"--Probe.Work=fail_slowly"});
  ASSERT_TRUE(
      eventually([&] { return child->error().find("stopping: it has failed") != std::string::npos; }));
  ASSERT_TRUE(child->signal(SIGTERM));
  EXPECT_EQ(child->waitForExit(kPatience), 1);
  EXPECT_THAT(child->error(), HasSubstr("the loop has failed"));
}

TEST_F(ComponentTest, MayEndByItself) {
  const auto child = probe({"--Probe.Work=finish"});
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
}

TEST_F(ComponentTest, ReportsVersionAndKeys) {
  const auto version = probe({"--version"});
  EXPECT_EQ(version->waitForExit(kPatience), 0);
  EXPECT_THAT(version->out(), MatchesRegex("probe_component [0-9.]+\n"));
  const auto help = probe({"--help"});
  EXPECT_EQ(help->waitForExit(kPatience), 0);
  EXPECT_THAT(help->out(), HasSubstr("usage: probe_component [--Ice.Config=FILE | FILE] [--Key=Value ...]"));
  EXPECT_THAT(help->out(), HasSubstr("\n  Probe.Size = 8   # "));
}

TEST_F(ComponentTest, ListsItsOwnKeysOneALine) {
  const auto list = probe({"--list-keys"});
  EXPECT_EQ(list->waitForExit(kPatience), 0);
  EXPECT_THAT(list->out(), HasSubstr("Probe.LogLevel\tbasic\tinfo\tone of: debug, info, warning, error\t"));
  EXPECT_THAT(list->out(), HasSubstr("\nProbe.Size\texpert\t8\t")) << "not described: for experts";
  EXPECT_EQ(list->out().find("Robot."), std::string::npos) << "keys of all components";
}

TEST_F(ComponentTest, ServesStatusAndEffectiveConfiguration) {
  const auto child = probe({config("Probe.Size = 3\n"), "--Ice.MessageSizeMax=2048"});
  const int port = child->port();
  ASSERT_GT(port, 0) << child->error();
  const auto status = statusAt(port);
  EXPECT_EQ(status.name, "probe_component");
  EXPECT_NE(status.version, "");
  EXPECT_EQ(status.state, avm::ComponentState::Running);
  EXPECT_EQ(status.reason, "");
  EXPECT_GE(status.uptimeS, 0.0);
  const auto component = Ice::checkedCast<avm::ComponentPrx>(
      communicator_->stringToProxy("probe_component/component:tcp -h 127.0.0.1 -p " + std::to_string(port)));
  std::map<std::string, std::string> settings;
  for (const auto& setting : component->getConfiguration()) settings[setting.key] = setting.value;
  EXPECT_EQ(settings["Probe.Size"], "3");
  EXPECT_EQ(settings["Probe.Work"], "serve") << "defaults are part of it";
  EXPECT_EQ(settings["Ice.MessageSizeMax"], "2048");
  EXPECT_EQ(settings["Ice.Default.InvocationTimeout"], "3000");
  // Output from before the ready line is read by another thread.
  EXPECT_EQ(child->stop(kPatience), 0);
  EXPECT_THAT(child->error(), HasSubstr("\n    Probe.Size = 3   # "));
}

TEST_F(ComponentTest, ComesUpWithoutItsPeerAndFindsItAgainAfterEveryLoss) {
  auto first = probe({});
  const int first_port = first->port();
  ASSERT_GT(first_port, 0) << first->error();
  const auto endpoint = "tcp -h 127.0.0.1 -p " + std::to_string(first_port);
  ASSERT_EQ(first->stop(kPatience), 0);

  const auto child = probe({"--Probe.Peer.Proxy=probe_component/component:" + endpoint});
  const int port = child->port();
  ASSERT_GT(port, 0) << child->error();
  EXPECT_TRUE(child->waitForLine("WARNING waiting for Peer at probe_component/component", kPatience));
  const auto waiting = statusAt(port);
  EXPECT_EQ(waiting.state, avm::ComponentState::WaitingForPeers);
  EXPECT_THAT(waiting.reason, HasSubstr("waiting for Peer at probe_component/component"));

  first = probe({"--Probe.Endpoints=" + endpoint});
  ASSERT_TRUE(child->waitForLine("INFO Peer is connected", kPatience)) << child->error();
  const auto running = waitForStatus(port, [](const auto& status) { return !status.rates.empty(); });
  EXPECT_EQ(running.state, avm::ComponentState::Running);
  ASSERT_EQ(running.rates.size(), 1u);
  EXPECT_EQ(running.rates[0].name, "calls");

  ASSERT_TRUE(first->signal(SIGKILL));
  ASSERT_TRUE(
      child->waitForLine("WARNING Peer is lost, waiting for it at probe_component/component", kPatience));
  const auto degraded = statusAt(port);
  EXPECT_EQ(degraded.state, avm::ComponentState::Degraded);
  ASSERT_EQ(degraded.peers.size(), 1u);
  EXPECT_FALSE(degraded.peers[0].connected);
  EXPECT_NE(degraded.peers[0].message, "");

  first = probe({"--Probe.Endpoints=" + endpoint});
  ASSERT_GT(first->port(), 0);
  const auto back = std::chrono::steady_clock::now();
  ASSERT_TRUE(child->waitForLine("INFO Peer is back", kPatience)) << child->error();
  EXPECT_LT(std::chrono::steady_clock::now() - back, 2s);
  const auto whole = statusAt(port);
  EXPECT_EQ(whole.state, avm::ComponentState::Running);
  EXPECT_EQ(whole.peers[0].reconnections, 1);
  EXPECT_EQ(child->stop(kPatience), 0);
  EXPECT_THAT(child->error(), Not(HasSubstr("ERROR")));
}

TEST_F(ComponentTest, GoesOnBesideAFrozenPeer) {
  auto first = probe({});
  const int first_port = first->port();
  ASSERT_GT(first_port, 0) << first->error();
  const auto child =
      probe({"--Probe.Peer.Proxy=probe_component/component:tcp -h 127.0.0.1 -p " + std::to_string(first_port),
             "--Ice.Default.InvocationTimeout=300"});
  const int port = child->port();
  ASSERT_TRUE(child->waitForLine("Peer is connected", kPatience)) << child->error();
  ASSERT_TRUE(first->signal(SIGSTOP));
  ASSERT_TRUE(child->waitForLine("Peer is lost", kPatience));
  const auto degraded = statusAt(port);
  EXPECT_EQ(degraded.state, avm::ComponentState::Degraded);
  EXPECT_EQ(degraded.reason, "Peer is lost (no answer in time)");
  ASSERT_TRUE(first->signal(SIGCONT));
  EXPECT_TRUE(child->waitForLine("Peer is back", kPatience));
  ASSERT_TRUE(first->signal(SIGSTOP));
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(child->stop(kPatience), 0) << "a frozen peer does not hold up a clean end";
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s);
}

TEST_F(ComponentTest, SaysWhenTheObjectThereIsOfAnotherKindOrAbsent) {
  const auto first = probe({});
  ASSERT_TRUE(first->waitUntilReady());
  const auto child = probe({"--Probe.Peer.Proxy=" + first->proxy("nobody")});
  const auto line = child->waitForLine("waiting for Peer", kPatience);
  ASSERT_TRUE(line);
  EXPECT_THAT(*line, HasSubstr("(no object nobody there)"));
}

}  // namespace
}  // namespace vismem
