#include "common/process/log_ring.h"

#include <algorithm>
#include <utility>

namespace vismem {
namespace {

/// Cuts a text of UTF-8 to at most `most` bytes, between two characters.
void cut(std::string& text, std::size_t most) {
  if (text.size() <= most) return;
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  while (most > 0 && continues(text[most])) --most;
  text.resize(most);
}

}  // namespace

void LogRing::add(LogLevel level, std::int64_t stamp_us, std::string text) {
  cut(text, kLongestText_bytes);
  const std::scoped_lock lock(mutex_);
  messages_.push_back({++last_seq_, stamp_us, level, std::move(text)});
  if (messages_.size() > kCapacity) messages_.pop_front();
}

LogRing::Batch LogRing::since(std::int64_t after_seq, LogLevel lowest, std::size_t most) const {
  const std::scoped_lock lock(mutex_);
  if (after_seq < 0 || after_seq > last_seq_) after_seq = 0;
  const std::int64_t first_held = last_seq_ - static_cast<std::int64_t>(messages_.size()) + 1;
  Batch batch;
  batch.last_seq = last_seq_;
  batch.lost = std::max<std::int64_t>(0, first_held - 1 - after_seq);
  for (const LogLine& message : messages_) {
    if (message.seq <= after_seq || message.level < lowest) continue;
    if (batch.messages.size() == most) {
      batch.last_seq = batch.messages.empty() ? after_seq : batch.messages.back().seq;
      break;
    }
    batch.messages.push_back(message);
  }
  return batch;
}

}  // namespace vismem
