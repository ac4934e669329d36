#include "recorder/core/ring_buffer.h"

#include <algorithm>

namespace vismem {
void RingBuffer::add(const RecordedMessage& message) {
  if (length_us_ == 0) return;
  if (message.topic->latched) {
    latched_[message.topic->channel.topic] = message;
    return;
  }
  if (clocks_.goesBack(message)) {
    messages_.clear();
    clocks_.clear();
    bytes_ = 0;
  }
  clocks_.add(message);
  if (!messages_.empty() && message.stamp_us < newest_us_ - length_us_) return;
  newest_us_ = messages_.empty() ? message.stamp_us : std::max(newest_us_, message.stamp_us);
  messages_.push_back(message);
  bytes_ += message.size();
  trim();
}

void RingBuffer::trim() {
  while (!messages_.empty() &&
         (bytes_ > max_bytes_ || messages_.front().stamp_us < newest_us_ - length_us_)) {
    bytes_ -= messages_.front().size();
    messages_.pop_front();
  }
}

std::vector<RecordedMessage> RingBuffer::contents() const {
  std::vector<RecordedMessage> all;
  for (const auto& [topic, message] : latched_) all.push_back(message);
  all.insert(all.end(), messages_.begin(), messages_.end());
  return all;
}

StampUs RingBuffer::lengthUs() const {
  return messages_.empty() ? 0 : newest_us_ - messages_.front().stamp_us;
}

}  // namespace vismem
