// A component under a service manager: a real process that reports to a socket of the test. Tests C2.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "support/component_process.h"
#include "support/notify_socket.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

class ServiceProcess : public testing::Test {
 protected:
  std::unique_ptr<ComponentProcess> probe(std::vector<std::string> arguments) {
    ChildProcess::Options options;
    options.environment = {{"NOTIFY_SOCKET", socket_.name()},
                           {"CREDENTIALS_DIRECTORY", folder_.path().string()}};
    return std::make_unique<ComponentProcess>("probe_component", std::move(arguments), std::move(options));
  }
  std::string next() { return socket_.next(kPatience).value_or("nothing"); }

  TemporaryFolder folder_;
  NotifySocket socket_{folder_ / "notify"};
};

TEST_F(ServiceProcess, IsReadyOnceItServesAndFeedsTheWatchdog) {
  const auto child = probe({});
  EXPECT_EQ(next(), "READY=1\nSTATUS=running\nWATCHDOG=1\n");
  ASSERT_TRUE(child->waitUntilReady());
  EXPECT_EQ(next(), "WATCHDOG=1\n");
  EXPECT_EQ(next(), "WATCHDOG=1\n");
  ASSERT_TRUE(child->signal(SIGTERM));
  std::string last = next();
  while (last == "WATCHDOG=1\n") last = next();
  EXPECT_EQ(last, "STOPPING=1\n");
  EXPECT_EQ(child->waitForExit(kPatience), 0) << child->error();
}

TEST_F(ServiceProcess, StopsFeedingTheWatchdogWhenItsLoopHangs) {
  const auto child = probe({"--Probe.Work=hang"});
  ASSERT_TRUE(child->waitForLine("ERROR loop: no progress for ", kPatience)) << child->error();
  std::string report = next();
  while (report.find("no progress") == std::string::npos && report != "nothing") report = next();
  EXPECT_THAT(report, StartsWith("STATUS=degraded: loop: no progress for "));
  // Three looks of the main thread: the state changes with the time, the watchdog is not fed.
  for (int i = 0; i < 3; ++i) EXPECT_EQ(next().find("WATCHDOG"), std::string::npos);
  EXPECT_EQ(child->stop(kPatience), 0);
}

TEST_F(ServiceProcess, IsNeverReadyWithAWrongConfiguration) {
  const auto child = probe({"--Probe.Size=0"});
  EXPECT_EQ(child->waitForExit(kPatience), 2);
  EXPECT_FALSE(socket_.next(0ms));
}

TEST_F(ServiceProcess, TakesItsTokenFromTheCredentials) {
  std::ofstream(folder_ / "Robot.Token") << "0123456789abcdef\n";
  const auto child = probe({"--Probe.WebEndpoints=ws -h 127.0.0.1 -p 0"});
  EXPECT_GT(child->port("ws"), 0) << "the endpoint for pages opens with a token only";
  EXPECT_EQ(child->error().find("0123456789abcdef"), std::string::npos);
}

TEST_F(ServiceProcess, ReportsAMalformedTokenWithoutItsValue) {
  std::ofstream(folder_ / "Robot.Token") << "short\n";
  const auto child = probe({});
  EXPECT_EQ(child->waitForExit(kPatience), 2);
  EXPECT_THAT(child->error(), HasSubstr("Robot.Token = *** (must be 16..100"));
}

}  // namespace
}  // namespace vismem
