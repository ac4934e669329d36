/// @file What the recorder does with the messages it is given: a recording that is on, and the last seconds
/// that may be saved. Pure: files and clock come from outside.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/ports.h"
#include "recorder/core/bag_recording.h"
#include "recorder/core/message_queue.h"
#include "recorder/core/ring_buffer.h"

namespace vismem {

/// Where recordings go. A recording is a folder, or whatever else the store makes of a name.
class RecordingStore {
 public:
  virtual ~RecordingStore() = default;
  /// @param name [A-Za-z0-9._-], not empty. @throws RecordingError when it is there already or cannot be
  /// made.
  virtual std::unique_ptr<PartStore> create(const std::string& name) = 0;
  /// For people and for replay_server: the path of a recording of that name.
  virtual std::string pathOf(const std::string& name) const = 0;
};

struct RecorderParams {
  BagRecordingParams bag;
  StampUs ring_us = 0;  ///< 0: no ring buffer
  std::size_t ring_bytes = 256u << 20;
};

struct RecorderReport {
  enum class State { kIdle, kRecording, kFailed };
  State state = State::kIdle;
  std::string message;  ///< kFailed: why
  std::string path;     ///< of the recording that is on, or of the last one
  int parts = 0;
  std::uint64_t bytes = 0;
  std::uint64_t messages = 0;
  std::optional<StampUs> begin_us;
  std::optional<StampUs> end_us;
  StampUs ring_us = 0;
  std::size_t ring_bytes = 0;
};

/// *Single-threaded* (owner: the writer's thread).
class RecorderCore {
 public:
  /// @param store must outlive it.
  RecorderCore(const RecorderParams& params, RecordingStore& store);

  /// @return the reply; its message is the recording's path when it is not rejected.
  PortReply start(const std::string& name);
  /// @return rejected when nothing is recorded, or with what went wrong at the end.
  PortReply stop();
  /// Saves the ring buffer as a recording of its own, also while another is on.
  PortReply saveRing(const std::string& name);

  void take(const RecordedMessage& message, StampUs clock_us);
  /// Writes what waits too long and reports drops when they have changed.
  void tick(StampUs clock_us);
  /// A note with a stamp, in the recording and the ring buffer. @return rejected for an empty or overlong
  /// text.
  PortReply mark(const std::string& text, StampUs stamp_us, StampUs clock_us);
  /// Puts the numbers of dropped and missed messages into the recording when they have changed.
  void reportDrops(const std::map<std::string, TopicCount>& counts, StampUs stamp_us, StampUs clock_us);

  RecorderReport report() const;

 private:
  void failed(const std::string& why);

  const RecorderParams params_;
  RecordingStore& store_;
  RingBuffer ring_;
  std::map<std::string, RecordedMessage> latched_;
  std::unique_ptr<PartStore> parts_;
  std::unique_ptr<BagRecording> recording_;
  RecorderReport last_;  ///< of the recording that has ended
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> reported_drops_;
};

/// A message of type std_msgs/String.
RecordedMessage textMessage(const std::shared_ptr<const LogTopic>& topic, StampUs stamp_us,
                            const std::string& text);
std::shared_ptr<const LogTopic> makeTopic(const std::string& name, const std::string& type,
                                          bool image = false, bool latched = false);

}  // namespace vismem
