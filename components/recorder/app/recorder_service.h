/// @file The recorder's two sides: streams hand messages in, one thread writes them. Memory between them is
/// bounded, so a slow disk costs messages and never the process.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "recorder/core/loss_detector.h"
#include "recorder/core/recorder_core.h"

namespace vismem {

/// *Thread-safe.* The store is used by the writer's thread alone and must outlive the service.
class RecorderService {
 public:
  struct Params {
    RecorderParams core;
    std::filesystem::path folder;  ///< of the recordings, for names that it has not yet
    std::size_t queue_bytes = 64u << 20;
    /// Saves the ring buffer so long after localization was lost; empty: it does not.
    std::optional<StampUs> save_after_loss_us;
    double loss_lost = 0.3;
    double loss_sure = 0.6;
  };
  struct Status {
    RecorderReport report;
    std::map<std::string, TopicCount> counts;
    std::size_t queue_bytes = 0;
    std::size_t queue_peak_bytes = 0;
    std::size_t queue_limit_bytes = 0;
    std::uint64_t dropped = 0;
  };
  using Command = std::function<PortReply(RecorderCore&)>;
  using Done = std::function<void(const PortReply&)>;
  /// Called twice a second with what the recorder does; on the writer's thread.
  using Watch = std::function<void(const Status&)>;
  /// Something happened that people want to read; on the writer's thread.
  using Note = std::function<void(const std::string&)>;

  RecorderService(const Params& params, RecordingStore& store);
  ~RecorderService() { stop(); }

  void start(Watch watch, Note note);
  /// Writes what waits, ends the recording and answers all commands.
  void stop();

  /// @return whether it was taken. Never waits.
  bool take(RecordedMessage message);
  void addMissed(const LogTopic& topic, std::uint64_t images);
  /// Of PoseEstimate; saves the ring buffer when the robot has just been lost.
  void updateReliability(double reliability, StampUs stamp_us);
  /// @return a name by date for a recording that is made now.
  std::string unusedName(const std::string& prefix = "") const;
  /// Runs on the writer's thread, behind the messages that wait now; `done` is called there.
  void execute(Command command, Done done);

  /// The newest stamp of the robot that a message had; 0 before the first.
  StampUs newestStamp() const;
  Status status() const;

 private:
  struct Pending {
    Command command;
    Done done;
  };

  void write(const std::stop_token& stop);
  void writeAll();
  void saveRingAfterLoss();
  void afterWriting();

  const Params params_;
  Watch watch_;
  Note note_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  MessageQueue queue_;
  std::deque<Pending> commands_;
  LossDetector loss_;
  std::optional<StampUs> save_at_us_;  ///< of stamps
  StampUs newest_us_ = 0;
  RecorderReport report_;  ///< as the writer's thread last knew it
  bool stopped_ = false;

  RecorderCore core_;  ///< of the writer's thread
  std::chrono::steady_clock::time_point watched_{};
  std::jthread writer_;  ///< last member: ends before the rest goes
};

}  // namespace vismem
