/// @file A worker for tasks of other processes: its thread and its servant.
#pragma once

#include <avm/worker.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>

namespace vismem {

/// How a worker runs its tasks.
struct WorkerSkill {
  /// @return what is wrong with a task; empty: nothing.
  std::function<std::string(const std::string& task)> problem;
  /// Runs a task. `look` is to be called at each step; what it throws must end the run. `part` gets the
  /// result so far. @return the result. @throws std::exception when the task fails.
  std::function<std::string(const std::string& task, const std::string& parts,
                            const std::function<void()>& look,
                            const std::function<void(const std::string&)>& part)>
      run;
};

/// Runs one task at a time. *Thread-safe*; `serve` is called by one thread.
class WorkerServant : public avm::Worker {
 public:
  /// A task that nobody asked for in this time gives way to another one.
  static constexpr std::chrono::seconds kForgotten{5};

  explicit WorkerServant(WorkerSkill skill) : skill_(std::move(skill)) {}

  /// Runs tasks until the stop.
  /// @param progress called at each step, and about every second without a task.
  /// @param finished called after each task with its name and what it failed of (empty: done).
  void serve(const std::stop_token& stop, const std::function<void()>& progress,
             const std::function<void(const std::string& id, const std::string& failure)>& finished);

  void begin(std::string id, std::string task, std::string parts, const Ice::Current&) override;
  avm::WorkReport report(std::string id, int known_parts, const Ice::Current&) override;

 private:
  struct Job {
    std::string id;
    std::string task;
    std::string parts;
    bool is_new = false;  ///< begun, but the thread has not taken it yet
    avm::WorkReport report{avm::WorkState::Working, 0, 0, ""};
    std::chrono::steady_clock::time_point asked;
  };

  /// One task from its begin to its end, or until another one takes its place.
  void run(const std::stop_token& stop, const Job& job, const std::function<void()>& progress,
           const std::function<void(const std::string&, const std::string&)>& finished);
  void look(const std::stop_token& stop, const std::string& id);

  const WorkerSkill skill_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  Job job_;
};

}  // namespace vismem
