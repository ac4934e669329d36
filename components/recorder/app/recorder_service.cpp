#include "recorder/app/recorder_service.h"

#include <chrono>
#include <utility>

#include "common/process/name_by_date.h"

namespace vismem {
namespace {

/// The writer looks so often at chunks that have been open for too long.
constexpr std::chrono::milliseconds kTick{50};
constexpr std::chrono::milliseconds kWatch{500};

StampUs clockNow() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

RecorderService::RecorderService(const Params& params, RecordingStore& store)
    : params_(params),
      queue_(params.queue_bytes),
      loss_(params.loss_lost, params.loss_sure),
      core_(params.core, store) {}

std::string RecorderService::unusedName(const std::string& prefix) const {
  return unusedNameByDate(params_.folder, prefix);
}

void RecorderService::start(Watch watch, Note note) {
  watch_ = std::move(watch);
  note_ = std::move(note);
  writer_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
}

void RecorderService::stop() {
  if (!writer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  writer_.request_stop();
  wake_.notify_all();
  writer_.join();
}

bool RecorderService::take(RecordedMessage message) {
  bool taken = false;
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return false;
    newest_us_ = message.stamp_us;
    taken = queue_.push(std::move(message));
  }
  wake_.notify_one();
  return taken;
}

void RecorderService::addMissed(const LogTopic& topic, std::uint64_t images) {
  const std::lock_guard lock(mutex_);
  queue_.addMissed(topic, images);
}

void RecorderService::updateReliability(double reliability, StampUs stamp_us) {
  const std::lock_guard lock(mutex_);
  if (!loss_.update(reliability) || !params_.save_after_loss_us || save_at_us_) return;
  save_at_us_ = stamp_us + *params_.save_after_loss_us;
}

void RecorderService::execute(Command command, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (!stopped_) {
      commands_.push_back({std::move(command), std::move(done)});
      done = {};
    }
  }
  if (done) done(PortReply::rejected("the recorder is stopping"));
  wake_.notify_one();
}

StampUs RecorderService::newestStamp() const {
  const std::lock_guard lock(mutex_);
  return newest_us_;
}

RecorderService::Status RecorderService::status() const {
  const std::lock_guard lock(mutex_);
  return {report_, queue_.counts(), queue_.bytes(), queue_.peakBytes(), queue_.limit(), queue_.dropped()};
}

void RecorderService::writeAll() {
  while (true) {
    std::optional<RecordedMessage> message;
    std::deque<Pending> commands;
    {
      const std::lock_guard lock(mutex_);
      message = queue_.pop();
      if (!message) commands.swap(commands_);
    }
    if (message) {
      core_.take(*message, clockNow());
      continue;
    }
    for (Pending& pending : commands) {
      const PortReply reply = pending.command(core_);
      {
        const std::lock_guard lock(mutex_);
        report_ = core_.report();
      }
      pending.done(reply);
    }
    if (commands.empty()) return;
  }
}

void RecorderService::saveRingAfterLoss() {
  {
    const std::lock_guard lock(mutex_);
    // The ring holds what was taken only once the queue is written; the next round looks again.
    if (!queue_.empty()) return;
    // A stamp far before the wanted one: the clock has jumped back, nothing newer of that epoch comes.
    const bool due = save_at_us_ && (newest_us_ >= *save_at_us_ ||
                                     newest_us_ < *save_at_us_ - *params_.save_after_loss_us - kSecondUs);
    if (!due) return;
    save_at_us_.reset();
  }
  const PortReply reply = core_.saveRing(unusedName("lost-"));
  note_(reply.ok() ? "localization was lost: the last seconds are saved in " + reply.message
                   : "localization was lost, but the last seconds cannot be saved: " + reply.message);
}

void RecorderService::afterWriting() {
  core_.tick(clockNow());
  saveRingAfterLoss();
  const auto now = std::chrono::steady_clock::now();
  if (now - watched_ < kWatch) return;
  watched_ = now;
  const Status before = status();
  core_.reportDrops(before.counts, newestStamp(), clockNow());
  {
    const std::lock_guard lock(mutex_);
    report_ = core_.report();
  }
  watch_(status());
}

void RecorderService::write(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    writeAll();
    afterWriting();
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kTick, [&] { return stopped_ || !queue_.empty() || !commands_.empty(); });
  }
  writeAll();
  const Status last = status();
  core_.reportDrops(last.counts, newestStamp(), clockNow());
  if (last.report.state == RecorderReport::State::kRecording) {
    const PortReply reply = core_.stop();
    note_(reply.ok() ? "recorded: " + reply.message : reply.message);
  }
}

}  // namespace vismem
