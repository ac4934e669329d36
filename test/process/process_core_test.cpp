// Units of common/process without Ice: metrics, peer state, status, log, ready line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "common/process/log.h"
#include "common/process/metrics.h"
#include "common/process/name_by_date.h"
#include "common/process/peer_state.h"
#include "common/process/ready_line.h"
#include "common/process/setup.h"
#include "common/process/status.h"
#include "common/process/stream_health.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const SteadyTime kStart = SteadyTime{} + 1000s;

TEST(Setup, RecorderAndMapperRunOnRequestOnly) {
  std::vector<std::string> names;
  for (const SetupComponent& component : componentsOfSetup(VISMEM_SOURCE_DIR "/cfg/sim"))
    names.push_back(component.name);
  EXPECT_THAT(names, ElementsAre("active_visual_memory", "gui_server", "localization", "simulator"));
}

TEST(NameByDate, SortsByTimeAsText) {
  const std::string name = nameByDate();
  EXPECT_THAT(name, testing::MatchesRegex("20[0-9]{6}-[0-9]{6}"));
  EXPECT_LE(name, nameByDate());
}

TEST(NameByDate, PassesOverNamesThatAreTaken) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    const std::string name = unusedNameByDate(folder.path(), "run-");
    EXPECT_THAT(name, testing::MatchesRegex("run-20[0-9]{6}-[0-9]{6}(-[23])?"));
    ASSERT_TRUE(std::filesystem::create_directory(std::filesystem::path(folder / name)))
        << name << " was there already";
  }
}

TEST(RateCounter, CountsPerSecondOverItsWindow) {
  RateCounter rate(5s);
  EXPECT_EQ(rate.hz(kStart), 0.0);
  // 11 events at 0, 100 ... 1000 ms: ten intervals in one second.
  for (int i = 0; i <= 10; ++i) rate.count(kStart + i * 100ms);
  EXPECT_NEAR(rate.hz(kStart + 1s), 10.0, 1e-9);
  for (int i = 11; i <= 100; ++i) rate.count(kStart + i * 100ms);
  EXPECT_NEAR(rate.hz(kStart + 10s), 10.0, 1e-9) << "50 events in the last 5 s";
  EXPECT_NEAR(rate.hz(kStart + 12500ms), 5.0, 0.21) << "half of the window is silent";
  EXPECT_EQ(rate.hz(kStart + 20s), 0.0) << "nothing in the window";
  EXPECT_EQ(rate.total(), 101);
}

TEST(RateCounter, StaysRightAndSmallAtHighRates) {
  RateCounter rate(5s);
  for (int i = 0; i <= 100'000; ++i) rate.count(kStart + i * 100us);
  EXPECT_NEAR(rate.hz(kStart + 10s), 10'000.0, 10.0);
}

TEST(LatencyHistogram, GivesPercentilesWithinFivePercent) {
  LatencyHistogram latency;
  // 1 ms, 2 ms ... 1000 ms: the percentiles are 500, 950 and 990 ms.
  std::vector<int> order(1000);
  for (int i = 0; i < 1000; ++i) order[i] = i + 1;
  std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
  for (const int ms : order) latency.add(kStart, 1e-3 * ms);
  const auto figures = latency.figures(kStart);
  EXPECT_EQ(figures.samples, 1000);
  EXPECT_NEAR(figures.p50_s, 0.500, 0.025);
  EXPECT_NEAR(figures.p95_s, 0.950, 0.048);
  EXPECT_NEAR(figures.p99_s, 0.990, 0.050);
  EXPECT_EQ(figures.max_s, 1.0);
}

TEST(LatencyHistogram, ForgetsAfterAMinute) {
  LatencyHistogram latency(30s);
  EXPECT_EQ(latency.figures(kStart).samples, 0);
  latency.add(kStart, 5.0);
  latency.add(kStart + 40s, 0.001);
  EXPECT_EQ(latency.figures(kStart + 40s).samples, 2);
  latency.add(kStart + 75s, 0.001);
  EXPECT_EQ(latency.figures(kStart + 75s).max_s, 0.001) << "the slow start is forgotten";
  EXPECT_EQ(latency.figures(kStart + 200s).samples, 0);
}

TEST(LatencyHistogram, TakesAnyNumber) {
  LatencyHistogram latency;
  for (const double odd : {0.0, -1.0, std::nan(""), 1e9}) latency.add(kStart, odd);
  EXPECT_EQ(latency.figures(kStart).samples, 4);
  EXPECT_EQ(latency.figures(kStart).max_s, 1e9);
}

TEST(PeerState, ReportsEachChangeOnce) {
  PeerState peer;
  using Change = PeerState::Change;
  EXPECT_TRUE(peer.mayTry(kStart));
  EXPECT_EQ(peer.failed(kStart, "connection refused"), Change::kWaiting);
  EXPECT_EQ(peer.failed(kStart + 1s, "connection refused"), Change::kNone);
  EXPECT_EQ(peer.link(), PeerState::Link::kAbsent);
  EXPECT_EQ(peer.succeeded(), Change::kConnected);
  EXPECT_EQ(peer.succeeded(), Change::kNone);
  EXPECT_EQ(peer.reason(), "");
  EXPECT_EQ(peer.failed(kStart + 2s, "timed out"), Change::kLost);
  EXPECT_EQ(peer.failed(kStart + 3s, "connection refused"), Change::kNone);
  EXPECT_EQ(peer.link(), PeerState::Link::kLost);
  EXPECT_EQ(peer.reason(), "connection refused");
  EXPECT_EQ(peer.succeeded(), Change::kBack);
  EXPECT_EQ(peer.reconnections(), 1);
}

TEST(PeerState, PausesLongerAfterEveryFailureUpToHalfASecond) {
  PeerState peer;
  std::vector<int> pauses_ms;
  auto now = kStart;
  for (int i = 0; i < 6; ++i) {
    peer.failed(now, "refused");
    int pause_ms = 0;
    while (!peer.mayTry(now + std::chrono::milliseconds(pause_ms))) ++pause_ms;
    pauses_ms.push_back(pause_ms);
    now += 10s;
  }
  EXPECT_THAT(pauses_ms, ElementsAre(50, 100, 200, 400, 500, 500));
  peer.succeeded();
  peer.failed(now, "refused");
  EXPECT_TRUE(peer.mayTry(now + 50ms)) << "success starts the pauses anew";
}

TEST(PeerState, NamesPeerPlaceAndReason) {
  using Change = PeerState::Change;
  const std::string proxy = "cameraA:tcp -p 9999";
  EXPECT_EQ(describeChange(Change::kWaiting, "Camera", proxy, "connection refused"),
            "waiting for Camera at cameraA:tcp -p 9999 (connection refused)");
  EXPECT_EQ(describeChange(Change::kConnected, "Camera", proxy, ""),
            "Camera is connected (cameraA:tcp -p 9999)");
  EXPECT_EQ(describeChange(Change::kLost, "Camera", proxy, "timed out"),
            "Camera is lost, waiting for it at cameraA:tcp -p 9999 (timed out)");
  EXPECT_EQ(describeChange(Change::kBack, "Camera", proxy, ""), "Camera is back");
}

class StatusTest : public testing::Test {
 protected:
  std::string stateText() {
    const auto report = board_.report();
    return nameOf(report.state) + (report.reason.empty() ? "" : ": " + report.reason);
  }

  SteadyTime now_ = kStart;
  std::ostringstream lines_;
  Logger log_{"eye", LogLevel::kInfo, lines_, [] { return "T"; }};
  StatusBoard board_{"eye", "1.2", log_, [this] { return now_; }};
};

TEST_F(StatusTest, StateFollowsFromPeersAndFaults) {
  using Link = PeerState::Link;
  EXPECT_EQ(stateText(), "starting");
  board_.setPeer({"Camera", "cameraA", Link::kAbsent, "refused", 0});
  board_.setPeer({"Base", "Motors", Link::kConnected, "", 0});
  board_.serving();
  EXPECT_EQ(stateText(), "waiting: waiting for Camera at cameraA");
  board_.setPeer({"Camera", "cameraA", Link::kConnected, "", 0});
  EXPECT_EQ(stateText(), "running");
  board_.setPeer({"Base", "Motors", Link::kLost, "timed out", 0});
  board_.fault("odometry", "no sample for 2 s");
  EXPECT_EQ(stateText(), "degraded: Base is lost (timed out); odometry: no sample for 2 s");
  board_.setPeer({"Base", "Motors", Link::kConnected, "", 1});
  board_.healthy("odometry");
  EXPECT_EQ(stateText(), "running");
  board_.stopping();
  EXPECT_EQ(stateText(), "stopping");
}

TEST_F(StatusTest, AStreamThatDriesUpIsAFault) {
  board_.serving();
  StreamHealth health(board_, "samples", "base");
  health.nothing("no sample yet", now_);
  now_ += std::chrono::milliseconds(900);
  health.nothing("no sample yet", now_);
  EXPECT_EQ(stateText(), "running") << "it may take its time";
  health.came(3, now_);
  now_ += std::chrono::milliseconds(1100);
  health.nothing("/dev/ttyUSB0 is gone", now_);
  EXPECT_EQ(stateText(), "degraded: base: /dev/ttyUSB0 is gone");
  health.came(1, now_);
  EXPECT_EQ(stateText(), "running");
  ASSERT_EQ(board_.report().rates.size(), 1U);
  EXPECT_EQ(board_.report().rates[0].total, 4);
}

TEST_F(StatusTest, FaultsAreLoggedOncePerChange) {
  for (int i = 0; i < 3; ++i) board_.fault("disk", "full");
  for (int i = 0; i < 3; ++i) board_.healthy("disk");
  for (int i = 0; i < 3; ++i) board_.error("a bad frame");
  EXPECT_EQ(lines_.str(),
            "T eye WARNING disk: full\nT eye INFO disk: back to normal\nT eye ERROR a bad frame\n");
  std::vector<std::string> errors;
  for (const auto& error : board_.report().errors) errors.push_back(error.text);
  EXPECT_THAT(errors, ElementsAre("disk: full", "a bad frame"));
}

// As of clocks that are out of step, 30 times a second.
TEST_F(StatusTest, AFaultWhoseDurationVariesIsLoggedOnce) {
  board_.serving();
  for (const char* seconds : {"4.9", "5.0", "12"})
    board_.fault("clock", "stamps are " + std::string(seconds) + " s ahead");
  EXPECT_EQ(stateText(), "degraded: clock: stamps are 12 s ahead");
  EXPECT_EQ(lines_.str(), "T eye WARNING clock: stamps are 4.9 s ahead\n");
  EXPECT_EQ(board_.report().errors.size(), 1U);
  board_.fault("clock", "stamps are 5.0 s behind");
  EXPECT_EQ(board_.report().errors.size(), 2U) << "another reason";
}

TEST_F(StatusTest, AThreadWithoutProgressDegradesAndIsLoggedOnce) {
  board_.serving();
  board_.alive("eyes", 2s);
  now_ += 1900ms;
  EXPECT_EQ(stateText(), "running");
  now_ += 300ms;
  EXPECT_EQ(stateText(), "degraded: eyes: no progress for 2.2 s");
  for (int i = 0; i < 3; ++i) board_.checkProgress();
  board_.alive("eyes", 2s);
  EXPECT_EQ(stateText(), "running");
  for (int i = 0; i < 3; ++i) board_.checkProgress();
  EXPECT_EQ(lines_.str(), "T eye ERROR eyes: no progress for 2.2 s\nT eye INFO eyes goes on\n");
  board_.ended("eyes");
  now_ += 10s;
  EXPECT_EQ(stateText(), "running") << "its end was no hanging";
}

TEST_F(StatusTest, KeepsTheLastErrors) {
  for (int i = 0; i < 100; ++i) board_.error("error " + std::to_string(i));
  const auto errors = board_.report().errors;
  ASSERT_EQ(errors.size(), 20u);
  EXPECT_EQ(errors.front().text, "error 80");
  EXPECT_EQ(errors.back().text, "error 99");
}

TEST_F(StatusTest, ReportsFigures) {
  for (int i = 0; i <= 20; ++i) {
    now_ = kStart + i * 50ms;
    board_.count("frames");
    board_.latency("detect", 0.004);
    board_.gauge({"camera roll error", 0.1 * i, 0.02, "deg"});
  }
  board_.gauge({"height", 0.45, 0.01, "m"});
  const auto report = board_.report();
  EXPECT_EQ(report.name, "eye");
  EXPECT_EQ(report.version, "1.2");
  EXPECT_NEAR(report.uptime_s, 1.0, 1e-9);
  ASSERT_EQ(report.rates.size(), 1u);
  EXPECT_EQ(report.rates[0].name, "frames");
  EXPECT_NEAR(report.rates[0].hz, 20.0, 1e-9);
  EXPECT_EQ(report.rates[0].total, 21);
  ASSERT_EQ(report.latencies.size(), 1u);
  EXPECT_NEAR(report.latencies[0].figures.p50_s, 0.004, 0.0002);
  ASSERT_EQ(report.gauges.size(), 2u);
  EXPECT_EQ(report.gauges[0].name, "camera roll error");
  EXPECT_NEAR(report.gauges[0].value, 2.0, 1e-9) << "the newest";
  EXPECT_EQ(report.gauges[0].sigma, 0.02);
  EXPECT_EQ(report.gauges[0].unit, "deg");
  EXPECT_EQ(report.gauges[1].name, "height");
}

TEST(Logger, DropsWhatIsBelowItsLevelAndIndentsLines) {
  std::ostringstream lines;
  Logger log("eye", LogLevel::kInfo, lines, [] { return "T"; });
  log.debug("unseen");
  log.info("two\nlines");
  log.setLowest(LogLevel::kError);
  log.warning("unseen");
  EXPECT_EQ(lines.str(), "T eye INFO two\n    lines\n");
}

TEST(ReadyLine, CarriesEndpointsAndPorts) {
  const auto line = readyLine("eye", "EyeAdapter", "tcp -h 127.0.0.1 -p 9970:ws -h 127.0.0.1 -p 11004");
  EXPECT_EQ(line, "eye ready: EyeAdapter=tcp -h 127.0.0.1 -p 9970:ws -h 127.0.0.1 -p 11004");
  EXPECT_EQ(readyEndpoints(line), "tcp -h 127.0.0.1 -p 9970:ws -h 127.0.0.1 -p 11004");
  EXPECT_EQ(readyEndpoints("eye is not ready"), std::nullopt);
}

TEST(Setup, KeysBelongToTheComponentOfTheirFirstPart) {
  EXPECT_TRUE(isKeyOf("replay_server", "ReplayServer.File"));
  EXPECT_TRUE(isKeyOf("pantilt_server", "PanTiltServer.Endpoints"));
  EXPECT_FALSE(isKeyOf("replay_server", "Replay.File"));
  EXPECT_FALSE(isKeyOf("recordings", "Recording.nao.FirstImage"));
  EXPECT_FALSE(isKeyOf("replay_server", "ReplayServer"));
}

TEST(Setup, ShiftPortsMovesEveryPortButEphemeralOnes) {
  EXPECT_EQ(shiftPorts("tcp -h 127.0.0.1 -p 9970:ws -h 127.0.0.1 -p 11004", 100),
            "tcp -h 127.0.0.1 -p 10070:ws -h 127.0.0.1 -p 11104");
  EXPECT_EQ(shiftPorts("cameraA:tcp -p 9999 -t 500", 1), "cameraA:tcp -p 10000 -t 500");
  EXPECT_EQ(shiftPorts("tcp -p 0", 5), "tcp -p 0");
  EXPECT_EQ(shiftPorts("", 5), "");
}

}  // namespace
}  // namespace vismem
