// What a process sends its service manager, and what it takes from it. Tests C2.
#include "common/process/service_manager.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "common/process/log.h"
#include "common/process/status.h"
#include "support/notify_socket.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

class ServiceManagerTest : public testing::Test {
 protected:
  std::string next() { return socket_.next(1s).value_or("nothing"); }
  bool silent() { return !socket_.next(50ms); }

  TemporaryFolder folder_;
  NotifySocket socket_{folder_ / "notify"};
};

TEST_F(ServiceManagerTest, SendsReadinessStateAndStop) {
  ServiceManager manager(socket_.name());
  ASSERT_TRUE(manager.listens());
  manager.report("starting", true);
  EXPECT_TRUE(silent()) << "the watchdog begins with the readiness";
  manager.ready("waiting: waiting for Camera at cameraA");
  EXPECT_EQ(next(), "READY=1\nSTATUS=waiting: waiting for Camera at cameraA\nWATCHDOG=1\n");
  manager.report("running", true);
  EXPECT_EQ(next(), "STATUS=running\nWATCHDOG=1\n");
  manager.report("running", true);
  EXPECT_EQ(next(), "WATCHDOG=1\n") << "the same state is sent once";
  manager.stopping();
  EXPECT_EQ(next(), "STOPPING=1\n");
}

TEST_F(ServiceManagerTest, DoesNotFeedTheWatchdogWithoutProgress) {
  ServiceManager manager(socket_.name());
  manager.ready("running");
  next();
  manager.report("degraded: perception: no progress for 5.2 s", false);
  EXPECT_EQ(next(), "STATUS=degraded: perception: no progress for 5.2 s\n");
  manager.report("degraded: perception: no progress for 5.2 s", false);
  EXPECT_TRUE(silent());
  manager.report("running", true);
  EXPECT_EQ(next(), "STATUS=running\nWATCHDOG=1\n");
}

TEST_F(ServiceManagerTest, AStateWithLineBreaksAssignsNothing) {
  ServiceManager manager(socket_.name());
  manager.ready("degraded: Camera is lost (a\nMAINPID=1\r\x7f)");
  EXPECT_EQ(next(), "READY=1\nSTATUS=degraded: Camera is lost (a MAINPID=1  )\nWATCHDOG=1\n");
}

TEST_F(ServiceManagerTest, RepeatsWhatTheManagerDidNotTake) {
  ServiceManager manager(socket_.name());
  socket_.shrink();
  ServiceManager other(socket_.name());
  // Fills the manager's queue until it takes nothing more.
  for (int i = 0; i < 1000; ++i) other.stopping();
  manager.ready("waiting");
  manager.report("running", true);
  while (socket_.next(0ms)) {
  }
  manager.report("running", true);
  EXPECT_EQ(next(), "READY=1\nSTATUS=running\nWATCHDOG=1\n") << "the readiness is not lost, the old state is";
}

TEST_F(ServiceManagerTest, SpeaksToAbstractSockets) {
  NotifySocket abstract("@vismem_test_" + std::to_string(getpid()));
  ServiceManager manager(abstract.name());
  manager.ready("running");
  EXPECT_EQ(abstract.next(1s), "READY=1\nSTATUS=running\nWATCHDOG=1\n");
}

TEST(ServiceManager, IsSilentWithoutAManager) {
  const std::string too_long = "/" + std::string(200, 'a');
  for (const std::string& socket :
       {std::string(), std::string("/"), std::string("@"), std::string("relative"),
        std::string("/no/such/socket"), std::string("vsock:2:1234"), too_long}) {
    ServiceManager manager(socket);
    EXPECT_FALSE(manager.listens()) << socket;
    manager.ready("running");
    manager.report("running", true);
    manager.stopping();
  }
}

TEST(JournalStream, IsTheFileOfDeviceAndInode) {
  const TemporaryFolder folder;
  const int file = open((folder / "journal").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  ASSERT_GE(file, 0);
  struct stat found {};
  ASSERT_EQ(fstat(file, &found), 0);
  const auto device = std::to_string(found.st_dev);
  const auto inode = std::to_string(found.st_ino);
  EXPECT_TRUE(leadsToJournal(file, device + ":" + inode));
  EXPECT_FALSE(leadsToJournal(file, device + ":" + std::to_string(found.st_ino + 1)))
      << "stderr was sent elsewhere";
  for (const std::string& text : {std::string(), std::string(":"), device, device + ":", ":" + inode,
                                  device + ":" + inode + "x", " " + device + ":" + inode})
    EXPECT_FALSE(leadsToJournal(file, text)) << text;
  close(file);
  EXPECT_FALSE(leadsToJournal(file, device + ":" + inode)) << "a closed descriptor";
}

TEST(Logger, WritesTheLevelsOfTheJournalOnEachLine) {
  std::ostringstream lines;
  Logger log(
      "eye", LogLevel::kDebug, lines, [] { return "T"; }, Logger::Format::kJournal);
  log.debug("a");
  log.info("two\nlines");
  log.warning("b");
  log.error("c\x1b[2J");
  EXPECT_EQ(lines.str(), "<7>a\n<6>two\n<6>    lines\n<4>b\n<3>c\\x1b[2J\n");
}

class CredentialsTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  std::string value(const std::string& key) {
    const auto* entry = properties_.find(key);
    return entry == nullptr ? "not set" : entry->value;
  }

  TemporaryFolder folder_;
  Properties properties_;
};

TEST_F(CredentialsTest, SetTheTokens) {
  write("Robot.Token", "0123456789abcdef\n");
  write("Robot.ViewToken", "");
  addCredentials(properties_, folder_.path());
  EXPECT_EQ(value("Robot.Token"), "0123456789abcdef");
  EXPECT_EQ(value("Robot.ViewToken"), "not set") << "an empty file is no token";
}

TEST_F(CredentialsTest, GiveWayToTheConfiguration) {
  write("Robot.Token", "0123456789abcdef");
  properties_.set("Robot.Token", "configured_token_1");
  addCredentials(properties_, folder_.path());
  EXPECT_EQ(value("Robot.Token"), "configured_token_1");
}

TEST_F(CredentialsTest, MayBeAbsent) {
  write("Robot.Token", "0123456789abcdef");
  addCredentials(properties_, "");
  addCredentials(properties_, folder_ / "absent");
  EXPECT_EQ(value("Robot.Token"), "not set");
}

TEST(StatusBoard, FeedsTheWatchdogWhileEveryThreadMakesProgress) {
  std::ostringstream lines;
  Logger log("eye", LogLevel::kInfo, lines, [] { return "T"; });
  SteadyTime now{};
  StatusBoard board("eye", "1", log, [&now] { return now; });
  board.serving();
  EXPECT_TRUE(board.checkProgress()) << "no thread is watched";
  board.alive("perception", 5s);
  board.alive("commands", 5s);
  EXPECT_EQ(board.stateLine(), "running");
  now += 4s;
  board.alive("commands", 5s);
  EXPECT_TRUE(board.checkProgress());
  now += 2s;
  EXPECT_FALSE(board.checkProgress()) << "one of two threads hangs";
  EXPECT_FALSE(board.checkProgress()) << "as long as it hangs";
  EXPECT_EQ(board.stateLine(), "degraded: perception: no progress for 6.0 s");
  board.alive("perception", 5s);
  EXPECT_TRUE(board.checkProgress());
}

}  // namespace
}  // namespace vismem
