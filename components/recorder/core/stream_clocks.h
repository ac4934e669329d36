/// @file Epochs of a recording. Pure.
#pragma once

#include <algorithm>
#include <map>

#include "recorder/core/log_message.h"

namespace vismem {

/// The newest stamp of each stream: of the messages that share a LogTopic. Streams are compared with
/// themselves alone, because a server gives the samples of its last seconds to a recorder that connects.
/// *Single-threaded.*
class StreamClocks {
 public:
  /// Whether the stream of this message goes back by over kClockBackUs: a new epoch.
  bool goesBack(const RecordedMessage& message) const {
    const auto newest = newest_us_.find(message.topic.get());
    return newest != newest_us_.end() && message.stamp_us < newest->second - kClockBackUs;
  }
  void add(const RecordedMessage& message) {
    StampUs& newest = newest_us_.try_emplace(message.topic.get(), message.stamp_us).first->second;
    newest = std::max(newest, message.stamp_us);
  }
  void clear() { newest_us_.clear(); }

 private:
  std::map<const LogTopic*, StampUs> newest_us_;
};

}  // namespace vismem
