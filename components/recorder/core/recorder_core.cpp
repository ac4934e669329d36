#include "recorder/core/recorder_core.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/config/file_name.h"
#include "common/recording/ros_messages.h"

namespace vismem {
namespace {

constexpr std::size_t kMaxMark = 10'000;
const char* const kMarks = "/recorder/marks";
const char* const kDrops = "/recorder/drops";

/// Text from outside may be no UTF-8: it is written with marks in the place of what is none.
std::string dump(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

std::shared_ptr<const LogTopic> makeTopic(const std::string& name, const std::string& type, bool image,
                                          bool latched) {
  return std::make_shared<const LogTopic>(LogTopic{{name, type}, image, latched});
}

RecordedMessage textMessage(const std::shared_ptr<const LogTopic>& topic, StampUs stamp_us,
                            const std::string& text) {
  return {topic, stamp_us, std::make_shared<const Bytes>(serialize(text))};
}

RecorderCore::RecorderCore(const RecorderParams& params, RecordingStore& store)
    : params_(params), store_(store), ring_(params.ring_us, params.ring_bytes) {}

PortReply RecorderCore::start(const std::string& name) {
  if (recording_) return PortReply::rejected("a recording is on already: " + last_.path);
  if (const std::string wrong = checkFileName(name); !wrong.empty()) return PortReply::rejected(wrong);
  try {
    parts_ = store_.create(name);
    recording_ = std::make_unique<BagRecording>(params_.bag, *parts_);
    for (const auto& [topic, message] : latched_) recording_->add(message, 0);
  } catch (const RecordingError& error) {
    recording_.reset();
    parts_.reset();
    last_ = {};
    last_.state = RecorderReport::State::kFailed;
    last_.message = error.what();
    return PortReply::rejected(error.what());
  }
  last_ = {};
  last_.state = RecorderReport::State::kRecording;
  last_.path = store_.pathOf(name);
  reported_drops_.clear();
  return {PortReply::Kind::kAccepted, last_.path};
}

void RecorderCore::failed(const std::string& why) {
  last_ = report();
  last_.state = RecorderReport::State::kFailed;
  last_.message = why;
  recording_.reset();
  parts_.reset();
}

PortReply RecorderCore::stop() {
  if (!recording_) return PortReply::rejected("nothing is recorded");
  try {
    recording_->finish();
  } catch (const RecordingError& error) {
    failed(error.what());
    return PortReply::rejected(error.what());
  }
  last_ = report();
  last_.state = RecorderReport::State::kIdle;
  recording_.reset();
  parts_.reset();
  return {PortReply::Kind::kAccepted, last_.path};
}

PortReply RecorderCore::saveRing(const std::string& name) {
  if (params_.ring_us == 0) {
    return PortReply::rejected("there is no ring buffer: Recorder.Ring.Length_s is 0");
  }
  if (const std::string wrong = checkFileName(name); !wrong.empty()) return PortReply::rejected(wrong);
  const std::vector<RecordedMessage> messages = ring_.contents();
  if (messages.empty()) return PortReply::rejected("the ring buffer is empty");
  try {
    const auto parts = store_.create(name);
    BagRecording saved(params_.bag, *parts);
    for (const RecordedMessage& message : messages) saved.add(message, 0);
    saved.finish();
  } catch (const RecordingError& error) {
    return PortReply::rejected(error.what());
  }
  return {PortReply::Kind::kAccepted, store_.pathOf(name)};
}

void RecorderCore::take(const RecordedMessage& message, StampUs clock_us) {
  if (message.topic->latched) latched_[message.topic->channel.topic] = message;
  ring_.add(message);
  if (!recording_) return;
  try {
    recording_->add(message, clock_us);
  } catch (const RecordingError& error) {
    failed(error.what());
  }
}

void RecorderCore::tick(StampUs clock_us) {
  if (!recording_) return;
  try {
    recording_->tick(clock_us);
  } catch (const RecordingError& error) {
    failed(error.what());
  }
}

PortReply RecorderCore::mark(const std::string& text, StampUs stamp_us, StampUs clock_us) {
  if (text.empty() || text.size() > kMaxMark) {
    return PortReply::rejected("a mark of " + std::to_string(text.size()) + " characters (must be 1.." +
                               std::to_string(kMaxMark) + ")");
  }
  if (!recording_ && params_.ring_us == 0) return PortReply::rejected("nothing is recorded");
  take(textMessage(makeTopic(kMarks, kStringType), stamp_us, dump({{"stamp_us", stamp_us}, {"text", text}})),
       clock_us);
  return PortReply::accepted();
}

void RecorderCore::reportDrops(const std::map<std::string, TopicCount>& counts, StampUs stamp_us,
                               StampUs clock_us) {
  if (!recording_) return;
  nlohmann::json topics = nlohmann::json::object();
  bool changed = false;
  for (const auto& [topic, count] : counts) {
    if (count.dropped == 0 && count.missed == 0) continue;
    auto& reported = reported_drops_[topic];
    changed = changed || reported != std::pair(count.dropped, count.missed);
    reported = {count.dropped, count.missed};
    topics[topic] = {{"dropped", count.dropped}, {"missed", count.missed}, {"recorded", count.messages}};
  }
  if (!changed) return;
  take(textMessage(makeTopic(kDrops, kStringType), stamp_us,
                   dump({{"stamp_us", stamp_us}, {"topics", topics}})),
       clock_us);
}

RecorderReport RecorderCore::report() const {
  RecorderReport report = last_;
  if (recording_) {
    report.parts = recording_->parts();
    report.bytes = recording_->bytes();
    report.messages = recording_->messages();
    report.begin_us = recording_->beginUs();
    report.end_us = recording_->endUs();
  }
  report.ring_us = ring_.lengthUs();
  report.ring_bytes = ring_.bytes();
  return report;
}

}  // namespace vismem
