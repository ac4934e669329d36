#include "recorder/core/message_queue.h"

#include <algorithm>
#include <utility>

namespace vismem {

TopicCount& MessageQueue::countOf(const LogTopic& topic) {
  TopicCount& count = counts_[topic.channel.topic];
  if (count.type.empty()) count.type = topic.channel.type;
  return count;
}

bool MessageQueue::push(RecordedMessage message) {
  TopicCount& count = countOf(*message.topic);
  const std::size_t limit = message.topic->image ? limit_ - limit_ / 10 : limit_;
  const std::size_t size = message.size();
  if (size > limit || bytes_ > limit - size) {
    ++count.dropped;
    ++dropped_;
    return false;
  }
  ++count.messages;
  count.bytes += message.bytes->size();
  bytes_ += size;
  peak_ = std::max(peak_, bytes_);
  messages_.push_back(std::move(message));
  return true;
}

std::optional<RecordedMessage> MessageQueue::pop() {
  if (messages_.empty()) return std::nullopt;
  RecordedMessage message = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= message.size();
  return message;
}

void MessageQueue::addMissed(const LogTopic& topic, std::uint64_t images) {
  countOf(topic).missed += images;
}

}  // namespace vismem
