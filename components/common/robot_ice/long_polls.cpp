#include "common/robot_ice/long_polls.h"

#include <algorithm>
#include <utility>

namespace vismem {

LongPolls::LongPolls() : timekeeper_([this](const std::stop_token& stop) { keepTime(stop); }) {}

LongPolls::~LongPolls() {
  stop();
}

void LongPolls::add(std::chrono::milliseconds timeout, Attempt attempt) {
  tryOrKeep({Clock::now() + timeout, std::move(attempt)});
}

void LongPolls::tryOrKeep(Request request) {
  for (;;) {
    std::uint64_t changes_before = 0;
    bool stopped = false;
    {
      const std::lock_guard lock(mutex_);
      changes_before = changes_;
      stopped = stopped_;
    }
    if (request.attempt(stopped) || stopped) return;
    Request oldest;
    {
      const std::lock_guard lock(mutex_);
      // A change after the attempt would be missed otherwise.
      if (stopped_ || changes_ != changes_before) continue;
      if (waiting_.size() >= kMaxWaiting) {
        oldest = std::move(waiting_.front());
        waiting_.erase(waiting_.begin());
      }
      waiting_.push_back(std::move(request));
    }
    wake_.notify_all();
    if (oldest.attempt) oldest.attempt(true);
    if (kept_) kept_();
    return;
  }
}

std::vector<LongPolls::Request> LongPolls::takeAll() {
  const std::lock_guard lock(mutex_);
  ++changes_;
  return std::exchange(waiting_, {});
}

void LongPolls::changed() {
  for (Request& request : takeAll()) tryOrKeep(std::move(request));
}

void LongPolls::giveUpAll() {
  for (Request& request : takeAll()) request.attempt(true);
}

void LongPolls::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  timekeeper_.request_stop();
  giveUpAll();
}

std::size_t LongPolls::waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

void LongPolls::keepTime(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (waiting_.empty()) {
      wake_.wait(lock, stop, [this] { return !waiting_.empty(); });
      continue;
    }
    const auto by_deadline = [](const Request& a, const Request& b) { return a.deadline < b.deadline; };
    const auto next = std::min_element(waiting_.begin(), waiting_.end(), by_deadline);
    const Clock::time_point deadline = next->deadline;
    if (Clock::now() < deadline) {
      // Requests that arrive meanwhile may end earlier: look again whenever woken.
      const std::uint64_t changes_before = changes_;
      const std::size_t count_before = waiting_.size();
      wake_.wait_until(lock, stop, deadline,
                       [&] { return changes_ != changes_before || waiting_.size() != count_before; });
      continue;
    }
    Request overdue = std::move(*next);
    waiting_.erase(next);
    lock.unlock();
    overdue.attempt(true);
    lock.lock();
  }
}

}  // namespace vismem
