#include "recorder/core/bag_recording.h"

#include <algorithm>
#include <utility>

namespace vismem {
BagRecording::BagRecording(const BagRecordingParams& params, PartStore& store)
    : params_(params), store_(store) {
  openPart();
}

BagRecording::~BagRecording() {
  try {
    finish();
  } catch (const RecordingError&) {
    // Whoever wants to know calls finish(); the chunks on the disk stay readable.
    encoder_.reset();
  }
}

template <typename Work>
void BagRecording::guarded(Work work) {
  try {
    work();
  } catch (const RecordingError& error) {
    bool finished = false;
    if (encoder_) {
      try {
        // A full disk often has room for the small index, once the chunk that did not fit was cut off.
        encoder_->finish();
        finished = true;
      } catch (const RecordingError&) {
        finished = false;
      }
      closed_bytes_ += encoder_->bytesWritten();
      closed_messages_ += encoder_->messagesWritten();
    }
    encoder_.reset();
    sink_.reset();
    store_.closed(part_, finished);
    throw RecordingError(std::string(error.what()) + ": the recording has ended; " +
                         std::to_string(closed_messages_) + " messages in " + std::to_string(part_ + 1) +
                         " parts are saved");
  }
}

void BagRecording::openPart() {
  sink_ = store_.open(part_);
  encoder_ = std::make_unique<BagEncoder>(*sink_, params_.compression);
  part_begin_us_.reset();
  clocks_.clear();
  chunk_opened_us_.reset();
}

void BagRecording::closePart() {
  encoder_->finish();
  closed_bytes_ += encoder_->bytesWritten();
  closed_messages_ += encoder_->messagesWritten();
  encoder_.reset();
  sink_.reset();
  store_.closed(part_, true);
}

bool BagRecording::isFull(const RecordedMessage& next) const {
  if (!part_begin_us_ || next.topic->latched) return false;
  if (clocks_.goesBack(next)) return true;
  if (params_.split_us > 0 && next.stamp_us - *part_begin_us_ >= params_.split_us) return true;
  return params_.split_bytes > 0 && encoder_->bytesWritten() + encoder_->openBytes() >= params_.split_bytes;
}

void BagRecording::put(const RecordedMessage& message, StampUs clock_us) {
  encoder_->add(message.topic->channel, message.stamp_us, *message.bytes);
  if (!chunk_opened_us_) chunk_opened_us_ = clock_us;
}

void BagRecording::add(const RecordedMessage& message, StampUs clock_us) {
  if (ended()) return;
  if (message.topic->latched) latched_[message.topic->channel.topic] = message;
  guarded([&] {
    if (isFull(message)) {
      closePart();
      ++part_;
      openPart();
      for (auto [topic, latched] : latched_) {
        // It holds for this part too, from its beginning.
        latched.stamp_us = message.stamp_us;
        put(latched, clock_us);
      }
    }
    const auto open_since = encoder_->openSince();
    if (open_since && message.stamp_us - *open_since >= params_.max_chunk_us) {
      encoder_->closeChunk();
      chunk_opened_us_.reset();
    }
    put(message, clock_us);
    if (!message.topic->latched) {
      if (!part_begin_us_) part_begin_us_ = message.stamp_us;
      clocks_.add(message);
      if (!begin_us_) begin_us_ = message.stamp_us;
      end_us_ = message.stamp_us;
    }
    if (encoder_->openBytes() >= params_.max_chunk_bytes) {
      encoder_->closeChunk();
      chunk_opened_us_.reset();
    }
  });
}

void BagRecording::tick(StampUs clock_us) {
  if (ended() || !chunk_opened_us_ || clock_us - *chunk_opened_us_ < params_.max_chunk_us) return;
  guarded([&] { encoder_->closeChunk(); });
  chunk_opened_us_.reset();
}

void BagRecording::finish() {
  if (ended()) return;
  guarded([&] { closePart(); });
}

std::uint64_t BagRecording::bytes() const {
  return closed_bytes_ + (encoder_ ? encoder_->bytesWritten() : 0);
}

std::uint64_t BagRecording::messages() const {
  return closed_messages_ + (encoder_ ? encoder_->messagesWritten() : 0);
}

}  // namespace vismem
