#include "simulator/app/render_pool.h"

#include <exception>
#include <utility>

namespace vismem {

RenderPool::RenderPool(int threads) {
  for (int i = 1; i < threads; ++i) {
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  }
}

RenderPool::~RenderPool() {
  for (auto& thread : threads_) thread.request_stop();
  threads_.clear();
}

void RenderPool::run(int count, const std::function<void(int)>& task) {
  const std::lock_guard one_at_a_time(runs_);
  std::unique_lock lock(mutex_);
  task_ = &task;
  next_ = 0;
  count_ = unfinished_ = count;
  begun_.notify_all();
  takeTasks(lock);
  done_.wait(lock, [this] { return unfinished_ == 0; });
  task_ = nullptr;
  if (auto failure = std::exchange(failure_, nullptr)) std::rethrow_exception(failure);
}

void RenderPool::takeTasks(std::unique_lock<std::mutex>& lock) {
  while (task_ != nullptr && next_ < count_) {
    const int index = next_++;
    const auto& task = *task_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      task(index);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !failure_) failure_ = failure;
    if (--unfinished_ == 0) done_.notify_all();
  }
}

void RenderPool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (begun_.wait(lock, stop, [this] { return task_ != nullptr && next_ < count_; })) takeTasks(lock);
}

}  // namespace vismem
