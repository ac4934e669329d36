/// @file The thread of a device session; it starts a new session after a loss.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include "common/drivers/retry_pause.h"
#include "common/robot/ports.h"

namespace vismem {

/// *Thread-safe*, except ready() and away(), which only the session calls.
class DeviceThread {
 public:
  struct Work {
    /// One session, from opening the device to its loss or the stop. It calls ready() when it accepts
    /// commands.
    /// @return the reason of its end; empty after a stop.
    std::function<std::string(const std::stop_token&)> session;
    /// Ends a wait of the session, after a stop was requested.
    std::function<void()> wake = [] {};
    /// Reports that the device is away, with the reason. Called on the thread, also by away().
    std::function<void(const std::string&)> away = [](const std::string&) {};
  };

  /// @param stopped reason for refusing commands between stop() and start(): "the base is stopped".
  DeviceThread(std::string stopped, Work work)
      : stopped_(std::move(stopped)), work_(std::move(work)), unavailable_(stopped_) {}
  ~DeviceThread() { stop(); }

  /// Starts the thread. Waits at most `patience` until the first session is ready or has failed.
  PortReply start(std::chrono::milliseconds patience = std::chrono::seconds(5)) {
    {
      const std::lock_guard control(control_);
      if (!thread_.joinable()) {
        {
          const std::lock_guard lock(mutex_);
          unavailable_ = "the device is being connected";
          tried_ = false;
          stopping_ = false;
        }
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
      }
    }
    // Without control_: stop() need not wait for this.
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [this] { return tried_ || stopping_; });
    return unavailable_.empty() ? PortReply::accepted() : PortReply::adjusted(unavailable_);
  }

  /// Returns after the end of the session.
  /// @return whether a session was running.
  bool stop() {
    const std::lock_guard control(control_);
    if (!thread_.joinable()) return false;
    {
      const std::lock_guard lock(mutex_);
      unavailable_ = stopped_;
      stopping_ = true;
    }
    changed_.notify_all();
    thread_.request_stop();
    work_.wake();
    thread_.join();
    thread_ = {};
    return true;
  }

  /// Accepts commands from now on.
  void ready() { setUnavailable({}); }
  /// Commands are refused with this reason, until ready().
  void away(const std::string& why) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
    }
    // Before start() returns: its caller must find the reason with the samples too.
    work_.away(why);
    setUnavailable(why);
  }

  /// Reason for refusing commands; empty while they are accepted.
  std::string unavailable() const {
    const std::lock_guard lock(mutex_);
    return unavailable_;
  }

 private:
  void setUnavailable(const std::string& why) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
      unavailable_ = why;
      tried_ = true;
      if (why.empty()) worked_ = true;
    }
    changed_.notify_all();
  }

  void run(const std::stop_token& stop) {
    RetryPause retry;
    while (!stop.stop_requested()) {
      const std::string why = work_.session(stop);
      if (stop.stop_requested() || why.empty()) return;
      away(why);
      std::unique_lock lock(mutex_);
      if (std::exchange(worked_, false)) retry.worked();
      changed_.wait_for(lock, stop, retry.failed(), [] { return false; });
    }
  }

  const std::string stopped_;
  const Work work_;
  std::mutex control_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::string unavailable_;
  bool tried_ = false;
  bool worked_ = false;  ///< this session was ready once
  bool stopping_ = false;
  std::jthread thread_;
};

}  // namespace vismem
