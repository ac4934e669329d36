/// @file Tasks that are given out to workers which may die. Pure.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace vismem {

/// Each task is waiting, out, or finished. A task that was lost with its worker is the next one to be given
/// out. *Single-threaded*.
class WorkList {
 public:
  struct Task {
    std::string name;   ///< unique
    std::string text;   ///< what a worker gets
    std::string parts;  ///< finished before; empty: nothing
  };
  /// A task that as many workers die of is no bad luck.
  static constexpr int kMostLosses = 20;

  /// Adds tasks that are not in the list yet.
  void add(std::vector<Task> tasks);
  /// Gives one out; empty: none waits.
  std::optional<Task> take();
  void keepParts(const std::string& name, std::string parts);
  void finish(const std::string& name);
  /// Its worker would not take it.
  void giveBack(const std::string& name);
  /// Its worker died.
  /// @throws std::runtime_error naming the task at the kMostLosses-th time.
  void lose(const std::string& name);

  std::size_t waiting() const { return queue_.size(); }
  int losses() const { return losses_; }

 private:
  struct Open {
    Task task;
    int losses = 0;
  };
  Open& find(const std::string& name);

  std::deque<std::string> queue_;
  std::vector<Open> open_;
  std::vector<std::string> known_;
  int losses_ = 0;
};

}  // namespace vismem
