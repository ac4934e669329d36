#include "recorder/core/message_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace vismem {

TopicCount& MessageQueue::countOf(const LogTopic& topic) {
  TopicCount& count = counts_[topic.channel.topic];
  if (count.type.empty()) count.type = topic.channel.type;
  return count;
}

void MessageQueue::makeRoom(std::size_t size) {
  while (images_ > 0 && size <= limit_ && bytes_ > limit_ - size) {
    const auto newest = std::find_if(messages_.rbegin(), messages_.rend(),
                                     [](const RecordedMessage& m) { return m.topic->image; });
    TopicCount& count = countOf(*newest->topic);
    --count.messages;
    count.bytes -= newest->bytes->size();
    ++count.dropped;
    ++dropped_;
    --images_;
    bytes_ -= newest->size();
    messages_.erase(std::next(newest).base());
  }
}

bool MessageQueue::push(RecordedMessage message) {
  const bool image = message.topic->image;
  TopicCount& count = countOf(*message.topic);
  const std::size_t limit = image ? limit_ - limit_ / 10 : limit_;
  const std::size_t size = message.size();
  if (!image) makeRoom(size);
  if (size > limit || bytes_ > limit - size) {
    ++count.dropped;
    ++dropped_;
    return false;
  }
  ++count.messages;
  count.bytes += message.bytes->size();
  bytes_ += size;
  images_ += image ? 1 : 0;
  peak_ = std::max(peak_, bytes_);
  messages_.push_back(std::move(message));
  return true;
}

std::optional<RecordedMessage> MessageQueue::pop() {
  if (messages_.empty()) return std::nullopt;
  RecordedMessage message = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= message.size();
  images_ -= message.topic->image ? 1 : 0;
  return message;
}

void MessageQueue::addMissed(const LogTopic& topic, std::uint64_t images) {
  countOf(topic).missed += images;
}

}  // namespace vismem
