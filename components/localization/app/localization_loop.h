/// @file The thread that owns the Localizer: updates in, estimates out, commands through a bounded queue.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/gaze/gaze_planner.h"
#include "localization/core/localizer.h"

namespace vismem {

/// *Thread-safe*: commands come from any thread, the Localizer is used by the loop's thread alone.
class LocalizationLoop {
 public:
  using Publish = std::function<void(const PoseEstimate&, double step_s)>;
  /// kRunning: updates arrive (again). Other states: none arrived for a while, or none will, with the reason.
  using SourceChanged = std::function<void(SourceState, const std::string& why)>;
  using Failed = std::function<void(std::exception_ptr)>;

  /// @param source must outlive the loop; its waits should end within a second.
  LocalizationLoop(Localizer localizer, VisualMemorySource& source);
  ~LocalizationLoop();

  using Ask = std::function<void(const GazePlan&, double plan_s)>;
  /// To be called before start(): every update's plan is passed to `ask`, from the loop's thread.
  void seekGaze(GazePlanner planner, Ask ask);

  /// All functions are called from the loop's thread.
  /// @param publish called with every new estimate.
  /// @param source_changed called with every change of the source's state.
  /// @param alive called in every round, at least twice per second.
  void start(Publish publish, SourceChanged source_changed, Failed failed, std::function<void()> alive);
  void stop();

  /// Localizes with another map from now on; the pose is kept where the map allows it. To be called from the
  /// loop's thread alone: by `alive`.
  /// @param planner  of the new map; only after seekGaze.
  void replaceMap(Localizer localizer, std::optional<GazePlanner> planner);

  /// Queued until before the loop's next update. Rejected if not finite or with a full queue.
  PortReply setPose(const Pose2& T_world_robot);
  PortReply relocalize();
  /// Has the loop's thread change the planner before its next update. Only after seekGaze.
  /// Rejected with a full queue.
  PortReply changePlanner(std::function<void(GazePlanner&)> change);
  /// The last update in use; without snapshot and analysis before the first one.
  MemoryUpdate newest() const;

 private:
  using Command = std::function<void()>;  ///< for the loop's thread
  static constexpr std::size_t kMaximumCommands = 16;

  PortReply enqueue(Command command);
  void runCommands();
  void run(const std::stop_token& stop);

  Localizer localizer_;
  std::optional<GazePlanner> planner_;  ///< empty: no gaze requests
  Ask ask_;
  VisualMemorySource& source_;
  Publish publish_;
  SourceChanged source_changed_;
  Failed failed_;
  std::function<void()> alive_;
  mutable std::mutex mutex_;
  std::deque<Command> commands_;
  MemoryUpdate newest_;
  std::jthread thread_;  ///< last member: it uses all of the above
};

}  // namespace vismem
