/// @file run_application: the main job. See options.h for its command line.
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "application/app/launcher.h"
#include "application/app/options.h"
#include "application/app/out_folder.h"
#include "application/app/report_writer.h"
#include "application/app/robot_link.h"
#include "application/app/run_inputs.h"
#include "application/app/run_observer.h"
#include "application/app/silence.h"
#include "application/app/status_line.h"
#include "common/config/config_error.h"
#include "common/routes/route.h"
#include "common/segment_map/symmetry.h"
#include "common/tool/end_signals.h"

namespace {

using namespace vismem;

constexpr std::chrono::seconds kReadyWithin{30};
constexpr std::chrono::seconds kPeersWithin{10};
/// Longest time from a recording's last image to its last estimate.
constexpr std::chrono::seconds kDrain{3};

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

bool isPaused(RobotLink& link) {
  return link.replay() != nullptr ? link.replay()->status().state == ReplayState::kPaused
                                  : link.simulation()->status().paused;
}

/// Shows the live status until the run ends: by time, by the recording's end, or by a signal.
void watch(const RunOptions& options, const Launcher& launcher, RobotLink& link, const RunObserver& observer,
           EndSignals& signals, StatusLine& status) {
  ReplayEnd replay_end;
  Silence silence;
  bool is_paused = false;
  while (!signals.wait(0.05)) {
    launcher.checkAlive();
    LiveState live = observer.live();
    const auto now = std::chrono::steady_clock::now();
    if (options.seconds && live.elapsed_s() >= *options.seconds) return;
    if (status.due(now)) {
      if (link.replay() != nullptr && replay_end.reached(*link.replay(), live)) return;
      live.is_paused = is_paused = isPaused(link);
      live.recording_failure = link.recordingFailure();
      status.show(statusText(live, link.gaze().status()));
    }
    if (silence.isTooLong(now, live.last_advance, is_paused) &&
        (link.replay() == nullptr || live.elapsed_s() == 0.0)) {
      throw ComponentFailure("no " + std::string(link.replay() ? "image" : "simulated time") + " came for " +
                             std::to_string(kSilence.count()) + " s");
    }
  }
}

/// Everything but the running itself: what is read beforehand, and where the results go.
struct RunInputs {
  RunMap map;
  std::optional<SimulatedOperator> driver;
  std::optional<ImageRange> judged;
  Trajectory truth;  ///< of a recording
};

RunInputs loadInputs(const RunOptions& options) {
  const std::filesystem::path palette = paletteOf(options);
  if (palette.empty() && options.session.empty()) {
    throw UsageError("no palette for " + options.map.string() +
                     " (must be --palette FILE, a file beside the map with the ending .palette, or the key "
                     "ActiveVisualMemory.Palette of the setup)");
  }
  RunInputs inputs{loadRunMap(options.map, palette), {}, {}, {}};
  if (options.setup == Setup::kSimulation) {
    const Route route = loadRoute(options.route);
    inputs.driver.emplace(startOnRoute(route, options.seed).backwards ? reversed(route) : route,
                          RouteFollowerParams{});
  } else {
    inputs.judged = judgedImages(options);
    inputs.truth = recordedTruth(options);
  }
  return inputs;
}

struct RecordedRun {
  RunRecord record;
  std::vector<std::string> problems;  ///< what ended it or its recording early
};

/// Runs the components until the end.
/// @param files made once the robot's time begins.
/// @return empty: stopped before that.
std::optional<RecordedRun> record(const RunOptions& options, EndSignals& signals, const RunInputs& inputs,
                                  std::optional<RunFiles>& files) {
  StatusLine status(std::cerr, isatty(STDERR_FILENO) == 1);
  const auto interrupted = [&] { return signals.arrived(); };
  Launcher launcher(options, commandsOf(options));
  if (!launcher.waitUntilReady(kReadyWithin, interrupted)) return std::nullopt;
  if (const auto page = pageAddressOf(options); !page.empty())
    std::cerr << "run_application: page " << page << std::endl;
  RobotLink link(options, launcher);
  const std::string missing = link.waitForPeers(kPeersWithin, interrupted);
  if (interrupted()) return std::nullopt;
  if (!missing.empty()) throw ComponentFailure("not all components found each other: " + missing);
  files.emplace(options.out);
  RunObserver observer({&link.camera(), &link.base(), &link.memory(), &link.localization(), link.simulation(),
                        !options.own_frame},
                       *files, inputs.driver, inputs.judged, symmetriesOf(inputs.map.edges));
  observer.start();
  const PortReply reply = link.replay() != nullptr ? link.replay()->play() : link.simulation()->resume();
  if (!reply.ok()) throw ComponentFailure("time does not begin: " + reply.message);
  std::vector<std::string> problems;
  try {
    watch(options, launcher, link, observer, signals, status);
  } catch (const ComponentFailure& lost) {
    problems.emplace_back(lost.what());  // what came until then is reported
  }
  if (const auto failure = link.recordingFailure(); !failure.empty())
    problems.push_back("recording failed: " + failure);
  status.end();
  observer.stop();
  return RecordedRun{observer.takeRecord(), std::move(problems)};
}

int run(const RunOptions& options, EndSignals& signals) {
  OutFolder folder(options.out);
  const RunInputs inputs = loadInputs(options);
  std::cerr << "run_application: setup " << options.folder << ", seed " << options.seed << ", results in "
            << options.out.string() << std::endl;
  if (options.own_frame)
    std::cerr << "run_application: " << options.map.string()
              << " has a frame of its own: no errors against the world's truth" << std::endl;
  std::optional<RunFiles> files;
  std::optional<RecordedRun> done = record(options, signals, inputs, files);
  if (!done) {
    std::cerr << "run_application: stopped before the components were ready" << std::endl;
    folder.discard();
    return 0;
  }
  RunRecord& recorded = done->record;
  if (!inputs.truth.empty() && !recorded.odometry.empty()) {
    const Trajectory& played = recorded.odometry;
    for (const StampedPose& pose : inputs.truth) {
      if (pose.stamp_us < played.front().stamp_us || pose.stamp_us > played.back().stamp_us) continue;
      recorded.truth.push_back(pose);
      files->addTruth(pose);
    }
  }
  const RunSummary summary = summarize(recorded, inputs.map.edges, inputs.judged.has_value());
  auto problems = writeReport(options, *files, recorded, summary, inputs.map);
  problems.insert(problems.end(), done->problems.begin(), done->problems.end());
  std::cout << resultJson(options, summary).dump() << std::endl;
  if (!summary.score.errors.empty() && !summary.score.recovered && !summary.score.is_twin) {
    std::cerr << "run_application: not localized at the end (is " << options.map.string()
              << " the map of this world?)" << std::endl;
  }
  for (const std::string& problem : problems) std::cerr << "run_application: " << problem << std::endl;
  return problems.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  EndSignals signals{SIGINT, SIGTERM, SIGHUP};
  try {
    const std::optional<RunOptions> options = parseOptions(argc, argv);
    return options ? run(*options, signals) : 0;
  } catch (const UsageError& error) {
    std::cerr << "run_application: " << error.what() << std::endl;
    return 2;
  } catch (const ConfigError& error) {
    std::cerr << "run_application: " << error.what() << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "run_application: " << error.what() << std::endl;
    return 1;
  }
}
