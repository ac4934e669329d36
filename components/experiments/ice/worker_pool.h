/// @file Gives tasks to workers over Ice, which may die, and collects the results.
#pragma once

#include <Ice/Ice.h>
#include <avm/worker.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "experiments/farm/work_list.h"

namespace vismem {

struct WorkerPoolOptions {
  /// Proxies of workers: with endpoints one worker each; with a replica group of an IceGrid registry all of
  /// its replicas.
  std::vector<std::string> workers;
  std::string locator;  ///< of the registry; may be empty
  /// Stores the result so far of a task (JSON). Called by any thread, one at a time; what it throws ends the
  /// run.
  std::function<void(const WorkList::Task& task, const std::string& result, bool is_whole)> store;
  std::function<void(const std::string&)> say;  ///< messages for people
};

/// A thread for each worker gives it one task after the other. A worker that does not answer for 5 s loses
/// its task and is asked again later; an IceGrid registry starts it meanwhile. *Thread-safe*.
class WorkerPool {
 public:
  /// @throws std::runtime_error naming a malformed proxy.
  explicit WorkerPool(WorkerPoolOptions options);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// @param also done under the lock under which results are stored.
  void add(std::vector<WorkList::Task> tasks, const std::function<void()>& also);
  /// Waits until `is_there` holds, which is asked under the same lock.
  /// @throws std::runtime_error when a task fails, or when no worker answers for two minutes.
  void wait(const std::function<bool()>& is_there);

 private:
  struct Worker {
    std::shared_ptr<avm::WorkerPrx> proxy;
    std::string name;
    std::jthread thread;
  };
  enum class End { kDone, kLost, kBusy };

  void discover(const std::stop_token& stop);
  void addWorkers(const std::vector<std::shared_ptr<Ice::ObjectPrx>>& proxies);
  std::vector<std::shared_ptr<Ice::ObjectPrx>> replicasOf(const std::shared_ptr<Ice::ObjectPrx>& proxy);
  void serve(const std::stop_token& stop, const Worker& worker);
  /// One task at one worker.
  End carryOut(const std::stop_token& stop, const Worker& worker, const WorkList::Task& task);
  void keep(const WorkList::Task& task, const std::string& result, bool is_whole);
  void heard();
  void fail(const std::string& why);
  /// @return false when the stop was requested meanwhile.
  bool pause(const std::stop_token& stop, std::chrono::milliseconds time);

  const WorkerPoolOptions options_;
  std::unique_ptr<Ice::CommunicatorHolder> communicator_;
  std::vector<std::shared_ptr<Ice::ObjectPrx>> proxies_;

  std::mutex mutex_;
  std::condition_variable_any changed_;
  WorkList list_;
  std::string failure_;
  std::chrono::steady_clock::time_point heard_;

  std::map<std::string, std::unique_ptr<Worker>> workers_;  ///< of the discovering thread
  std::jthread discovery_;
};

}  // namespace vismem
