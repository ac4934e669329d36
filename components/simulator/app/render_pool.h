/// @file Threads that share the rays of an image.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace vismem {

/// Shares tasks between the caller and threads of its own. *Thread-safe*: runs exclude each other.
class RenderPool {
 public:
  /// @param threads in all, the caller's included; 1 or less: everything on the caller's.
  explicit RenderPool(int threads);
  ~RenderPool();
  RenderPool(const RenderPool&) = delete;
  RenderPool& operator=(const RenderPool&) = delete;

  /// Calls task(0) .. task(count - 1) and returns when all are done. The first exception of a task is thrown
  /// on.
  void run(int count, const std::function<void(int)>& task);

 private:
  void work(const std::stop_token& stop);
  void takeTasks(std::unique_lock<std::mutex>& lock);

  std::mutex runs_;
  std::mutex mutex_;
  std::condition_variable_any begun_;
  std::condition_variable done_;
  const std::function<void(int)>* task_ = nullptr;  ///< null: nothing to do
  int next_ = 0;
  int count_ = 0;
  int unfinished_ = 0;
  std::exception_ptr failure_;
  std::vector<std::jthread> threads_;  ///< last: end before the rest goes
};

}  // namespace vismem
