/// @file run_application: the main job. See options.h for its command line.
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "application/app/launcher.h"
#include "application/app/options.h"
#include "application/app/report_writer.h"
#include "application/app/robot_link.h"
#include "application/app/run_inputs.h"
#include "application/app/run_observer.h"
#include "application/app/status_line.h"
#include "common/config/config_error.h"

namespace {

using namespace vismem;

constexpr std::chrono::seconds kReadyWithin{30};
constexpr std::chrono::seconds kPeersWithin{10};
/// Longest time without data before the run fails; longer than any pause of a working robot.
constexpr std::chrono::seconds kSilence{15};
/// Longest time from a recording's last image to its last estimate.
constexpr std::chrono::seconds kDrain{3};

/// Polls SIGINT, SIGTERM and SIGHUP. They are blocked in all threads, so construct it before the first
/// thread.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, number);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// Waits at most this long.
  /// @return whether a stop was requested, now or before.
  bool wait(std::chrono::milliseconds timeout) {
    const timespec limit{timeout.count() / 1000, timeout.count() % 1000 * 1'000'000};
    if (!asked_ && sigtimedwait(&set_, nullptr, &limit) > 0) asked_ = true;
    return asked_;
  }

 private:
  sigset_t set_{};
  bool asked_ = false;
};

/// Detects that a recording has ended and its last estimate has arrived.
class ReplayEnd {
 public:
  bool reached(ReplayControl& replay, const LiveState& live) {
    const auto now = std::chrono::steady_clock::now();
    if (replay.status().state != ReplayState::kFinished) return false;
    if (!finished_) finished_ = now;
    return live.last_estimate_us >= live.last_image_us || now - *finished_ > kDrain;
  }

 private:
  std::optional<std::chrono::steady_clock::time_point> finished_;
};

/// Shows the live status until the run ends: by time, by the recording's end, or by a signal.
void watch(const RunOptions& options, const Launcher& launcher, RobotLink& link, const RunObserver& observer,
           StopSignals& signals, StatusLine& status) {
  ReplayEnd replay_end;
  while (!signals.wait(std::chrono::milliseconds(50))) {
    launcher.checkAlive();
    const LiveState live = observer.live();
    const auto now = std::chrono::steady_clock::now();
    if (options.seconds && live.elapsed_s() >= *options.seconds) return;
    if (status.due(now)) {
      if (link.replay() != nullptr && replay_end.reached(*link.replay(), live)) return;
      status.show(statusText(live, link.gaze().status()));
    }
    if (now - live.last_advance > kSilence && (link.replay() == nullptr || live.elapsed_s() == 0.0)) {
      throw ComponentFailure("no " + std::string(link.replay() ? "image" : "simulated time") + " came for " +
                             std::to_string(kSilence.count()) + " s");
    }
  }
}

int run(const RunOptions& options, StopSignals& signals) {
  const RunMap map = loadRunMap(options.map, paletteOf(options));
  std::optional<SimulatedOperator> driver;
  std::optional<ImageRange> judged;
  if (options.setup == Setup::kSimulation) {
    const Route route = loadRoute(options.route);
    driver.emplace(startOnRoute(route, options.seed).backwards ? reversed(route) : route,
                   RouteFollowerParams{});
  } else {
    judged = judgedImages(options);
  }
  std::cerr << "run_application: setup " << options.folder << ", seed " << options.seed << ", results in "
            << options.out.string() << std::endl;

  StatusLine status(std::cerr, isatty(STDERR_FILENO) == 1);
  const auto interrupted = [&] { return signals.wait(std::chrono::milliseconds(0)); };
  RunRecord record;
  {
    Launcher launcher(options, commandsOf(options));
    if (!launcher.waitUntilReady(kReadyWithin, interrupted)) {
      std::cerr << "run_application: stopped before the components were ready" << std::endl;
      return 1;
    }
    if (const auto page = pageAddressOf(options); !page.empty())
      std::cerr << "run_application: page " << page << std::endl;
    RobotLink link(options, launcher);
    RunObserver observer(
        {&link.camera(), &link.base(), &link.memory(), &link.localization(), link.simulation()},
        std::move(driver), judged);
    const std::string missing = link.waitForPeers(kPeersWithin, interrupted);
    if (!missing.empty()) throw ComponentFailure("not all components found each other: " + missing);
    observer.start();
    const PortReply reply = link.replay() != nullptr ? link.replay()->play() : link.simulation()->resume();
    if (!reply.ok()) throw ComponentFailure("time does not begin: " + reply.message);
    try {
      watch(options, launcher, link, observer, signals, status);
    } catch (...) {
      status.end();
      throw;
    }
    status.end();
    observer.stop();
    record = observer.takeRecord();
  }
  const RunSummary summary = summarize(record, map.edges, judged.has_value());
  writeReport(options, record, summary, map);
  std::cout << resultJson(options, summary).dump() << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  StopSignals signals;
  try {
    const std::optional<RunOptions> options = parseOptions(argc, argv);
    return options ? run(*options, signals) : 0;
  } catch (const UsageError& error) {
    std::cerr << "run_application: " << error.what() << std::endl;
    return 2;
  } catch (const ConfigError& error) {
    for (const std::string& problem : error.problems())
      std::cerr << "run_application: " << problem << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "run_application: " << error.what() << std::endl;
    return 1;
  }
}
