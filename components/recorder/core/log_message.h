/// @file One message on its way into a recording. Pure.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "common/recording/bag_encoder.h"
#include "common/robot/samples.h"

namespace vismem {

struct LogTopic {
  BagChannel channel;
  bool image = false;  ///< large: dropped first when the disk is too slow
  /// Holds until the next one comes (a map, static transforms): every part of a recording begins with the
  /// last.
  bool latched = false;
};

/// The bytes are shared between the queue, the ring buffer and the recording, and never written again.
struct RecordedMessage {
  std::shared_ptr<const LogTopic> topic;
  StampUs stamp_us = 0;
  std::shared_ptr<const Bytes> bytes;

  /// Memory that it holds, with its own bookkeeping.
  std::size_t size() const { return bytes->size() + sizeof(RecordedMessage) + 64; }
};

inline RecordedMessage recordedMessage(const std::shared_ptr<const LogTopic>& topic, StampUs stamp_us,
                                       Bytes bytes) {
  return {topic, stamp_us, std::make_shared<const Bytes>(std::move(bytes))};
}

/// A stamp that goes back by more begins a new epoch.
constexpr StampUs kClockBackUs = kSecondUs;

/// Of a topic, since the recorder's start.
struct TopicCount {
  std::string type;
  std::uint64_t messages = 0;  ///< accepted and not dropped since
  std::uint64_t bytes = 0;     ///< of these
  std::uint64_t dropped = 0;   ///< because the queue was full
  std::uint64_t missed = 0;    ///< captured, but passed over before they reached the recorder
};

}  // namespace vismem
