/// @file Long-polls of a server: requests wait for new data and are answered at the latest after a timeout.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace vismem {

/// Maximum wait of a long-poll.
constexpr std::chrono::milliseconds kLongPollWait{1000};

/// Waiting asynchronous requests. A request is an attempt: called with false, it answers if there is new data
/// and returns whether it answered; called with true, it must answer. Each request is answered exactly once,
/// after at most its timeout, and on stop() at once. Attempts run on the thread that adds, reports a change
/// or keeps the time, never under a lock of this class; they must not throw. *Thread-safe.*
class LongPolls {
 public:
  using Attempt = std::function<bool(bool last_chance)>;

  LongPolls();
  ~LongPolls();
  LongPolls(const LongPolls&) = delete;
  LongPolls& operator=(const LongPolls&) = delete;

  /// Called after each request that is kept, on the thread that kept it. To be set before the first request.
  void onKept(std::function<void()> kept) { kept_ = std::move(kept); }
  /// Tries at once and keeps an unanswered request. Above kMaxWaiting kept requests the oldest is answered
  /// early, which bounds the memory of the server.
  void add(std::chrono::milliseconds timeout, Attempt attempt);
  /// Reports new data: all waiting requests are tried.
  void changed();
  /// Answers all waiting requests, because no new data will come.
  void giveUpAll();
  /// As giveUpAll, and later requests are answered at once. May be called again.
  void stop();
  std::size_t waiting() const;

  static constexpr std::size_t kMaxWaiting = 256;

 private:
  using Clock = std::chrono::steady_clock;
  struct Request {
    Clock::time_point deadline;
    Attempt attempt;
  };

  void tryOrKeep(Request request);
  std::vector<Request> takeAll();
  void keepTime(const std::stop_token& stop);

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::vector<Request> waiting_;  ///< in the order of their arrival
  std::uint64_t changes_ = 0;
  bool stopped_ = false;
  std::function<void()> kept_;
  std::jthread timekeeper_;
};

}  // namespace vismem
