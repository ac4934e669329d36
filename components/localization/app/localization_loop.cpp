#include "localization/app/localization_loop.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace vismem {
namespace {

/// Longest wait for an update, and so the longest delay of a command.
constexpr std::chrono::milliseconds kWait{100};
/// A memory without an update for this long counts as silent: recordings have down to two images per second.
constexpr std::chrono::milliseconds kQuiet{1500};

}  // namespace

LocalizationLoop::LocalizationLoop(Localizer localizer, VisualMemorySource& source)
    : localizer_(std::move(localizer)), source_(source) {}

LocalizationLoop::~LocalizationLoop() {
  stop();
}

void LocalizationLoop::seekGaze(GazePlanner planner, Ask ask) {
  planner_.emplace(std::move(planner));
  ask_ = std::move(ask);
}

void LocalizationLoop::start(Publish publish, SourceChanged source_changed, Failed failed,
                             std::function<void()> alive) {
  publish_ = std::move(publish);
  source_changed_ = std::move(source_changed);
  failed_ = std::move(failed);
  alive_ = std::move(alive);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    try {
      run(stop);
    } catch (...) {
      failed_(std::current_exception());
    }
  });
}

void LocalizationLoop::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

PortReply LocalizationLoop::setPose(const Pose2& T_world_robot) {
  {
    const std::lock_guard lock(mutex_);  // the map may be replaced
    if (const std::string problem = localizer_.problemOf(T_world_robot); !problem.empty()) {
      return PortReply::rejected(problem);
    }
  }
  return enqueue([this, T_world_robot] { localizer_.setPose(T_world_robot); });
}

void LocalizationLoop::replaceMap(Localizer localizer, std::optional<GazePlanner> planner) {
  const PoseEstimate last = localizer_.latest();
  // The new one begins at the same observation and place.
  if (newest_.snapshot) localizer.update(newest_);
  if (last.T_world_robot && localizer.problemOf(*last.T_world_robot).empty()) {
    localizer.setPose(*last.T_world_robot);
  }
  if (planner) planner_.emplace(std::move(*planner));
  const std::lock_guard lock(mutex_);
  localizer_ = std::move(localizer);
}

PortReply LocalizationLoop::relocalize() {
  return enqueue([this] { localizer_.relocalize(); });
}

PortReply LocalizationLoop::changePlanner(std::function<void(GazePlanner&)> change) {
  return enqueue([this, change = std::move(change)] { change(*planner_); });
}

PortReply LocalizationLoop::enqueue(Command command) {
  const std::lock_guard lock(mutex_);
  if (commands_.size() >= kMaximumCommands) {
    return PortReply::rejected(std::to_string(commands_.size()) + " commands are waiting already");
  }
  commands_.push_back(std::move(command));
  return PortReply::accepted();
}

MemoryUpdate LocalizationLoop::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void LocalizationLoop::runCommands() {
  std::deque<Command> commands;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
  }
  for (const Command& command : commands) command();
}

void LocalizationLoop::run(const std::stop_token& stop) {
  std::uint64_t memory_revision = 0;
  std::optional<std::pair<SourceState, std::string>> reported;
  auto last_update = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    alive_();
    const std::uint64_t known = localizer_.latest().revision;
    runCommands();
    // Before the first update an estimate has no stamp; commands are published with that update.
    if (localizer_.latest().revision != known && memory_revision != 0) publish_(localizer_.latest(), 0.0);
    const MemoryResult result = source_.next(memory_revision, kWait);
    const auto now = std::chrono::steady_clock::now();
    const bool has_update =
        result.state == SourceState::kRunning && result.update.snapshot && result.update.analysis;
    if (has_update) last_update = now;
    // A single wait without an update is normal for a running source; a long silence is not.
    if (has_update || result.state == SourceState::kFinished || now - last_update > kQuiet) {
      std::pair<SourceState, std::string> found{has_update ? SourceState::kRunning : result.state,
                                                result.message};
      if (reported != found) {
        source_changed_(found.first, found.second);
        reported = std::move(found);
      }
    }
    if (!has_update) {
      if (result.state == SourceState::kFinished) std::this_thread::sleep_for(kWait);
      continue;
    }
    memory_revision = result.update.snapshot->revision;
    const std::uint64_t before = localizer_.latest().revision;
    const auto begin = std::chrono::steady_clock::now();
    const auto spent_s = [&begin] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    const PoseEstimate& estimate = localizer_.update(result.update);
    if (estimate.revision == before) continue;
    const double step_s = spent_s();
    {
      const std::lock_guard lock(mutex_);
      newest_ = result.update;
    }
    publish_(estimate, step_s);
    if (!planner_) continue;
    const GazePlan plan = planner_->plan(estimate, result.update);
    ask_(plan, spent_s() - step_s);
  }
}

}  // namespace vismem
