#include "experiments/ice/worker_pool.h"

#include <IceGrid/IceGrid.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "common/process/ice_failure.h"
#include "common/process/ice_setup.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kPoll{250};
constexpr milliseconds kDiscovery{5000};
/// Without an answer for this long a worker has lost its task.
constexpr milliseconds kSilence{5000};
/// Without a step for this long it has, too: it hangs.
constexpr milliseconds kStandstill{60'000};
/// Without an answer of any worker the pool gives up.
constexpr milliseconds kPatience{120'000};

std::unique_ptr<Ice::CommunicatorHolder> makeClient(const std::string& locator) {
  Ice::InitializationData data;
  data.properties = Ice::createProperties();
  for (const auto& setting : iceDefaults()) data.properties->setProperty(setting.key, setting.value);
  // A worker that was started again has other endpoints.
  data.properties->setProperty("Ice.Default.LocatorCacheTimeout", "1");
  if (!locator.empty()) data.properties->setProperty("Ice.Default.Locator", locator);
  try {
    return std::make_unique<Ice::CommunicatorHolder>(Ice::initialize(data));
  } catch (const Ice::LocalException& failure) {
    throw std::runtime_error("locator " + locator + ": " + describeFailure(failure));
  }
}

}  // namespace

WorkerPool::WorkerPool(WorkerPoolOptions options)
    : options_(std::move(options)), communicator_(makeClient(options_.locator)), heard_(steady_clock::now()) {
  for (const std::string& text : options_.workers) {
    try {
      proxies_.push_back((*communicator_)->stringToProxy(text));
    } catch (const Ice::LocalException& failure) {
      throw std::runtime_error("workers \"" + text + "\": " + describeFailure(failure));
    }
    if (!proxies_.back()) throw std::runtime_error("workers \"" + text + "\": no proxy");
    if (proxies_.back()->ice_getEndpoints().empty() && options_.locator.empty()) {
      throw std::runtime_error("workers \"" + text + "\": has no endpoint, and no --locator would find one");
    }
  }
  discovery_ = std::jthread([this](const std::stop_token& stop) { discover(stop); });
}

WorkerPool::~WorkerPool() {
  discovery_.request_stop();
  // Ends the calls in flight.
  (*communicator_)->destroy();
  discovery_.join();
  for (const auto& [name, worker] : workers_) worker->thread.request_stop();
  workers_.clear();
}

void WorkerPool::add(std::vector<WorkList::Task> tasks, const std::function<void()>& also) {
  const std::scoped_lock lock(mutex_);
  also();
  list_.add(std::move(tasks));
  heard_ = steady_clock::now();
  changed_.notify_all();
}

void WorkerPool::wait(const std::function<bool()>& is_there) {
  std::unique_lock lock(mutex_);
  while (!is_there()) {
    if (!failure_.empty()) throw std::runtime_error(failure_);
    if (steady_clock::now() - heard_ > kPatience) {
      throw std::runtime_error("no worker answers; finished trials are kept, and the same command continues");
    }
    changed_.wait_for(lock, milliseconds(500));
  }
}

void WorkerPool::discover(const std::stop_token& stop) {
  do {
    for (const auto& proxy : proxies_) {
      try {
        addWorkers(replicasOf(proxy));
      } catch (const std::exception&) {
        // The registry is away: those that are known go on.
      }
    }
  } while (pause(stop, kDiscovery));
}

std::vector<std::shared_ptr<Ice::ObjectPrx>> WorkerPool::replicasOf(
    const std::shared_ptr<Ice::ObjectPrx>& proxy) {
  if (!proxy->ice_getEndpoints().empty()) return {proxy};
  const auto locator = (*communicator_)->getDefaultLocator();
  const auto query = Ice::uncheckedCast<IceGrid::QueryPrx>(
      (*communicator_)->stringToProxy(locator->ice_getIdentity().category + "/Query"));
  auto replicas = query->findAllReplicas(proxy);
  if (replicas.empty()) return {proxy};
  return replicas;
}

void WorkerPool::addWorkers(const std::vector<std::shared_ptr<Ice::ObjectPrx>>& proxies) {
  for (const auto& proxy : proxies) {
    const std::string name = proxy->ice_toString();
    if (workers_.contains(name)) continue;
    auto& worker = *(workers_[name] = std::make_unique<Worker>());
    worker.proxy = Ice::uncheckedCast<avm::WorkerPrx>(proxy->ice_connectionId(name));
    worker.name = proxy->ice_getAdapterId().empty() ? name : proxy->ice_getAdapterId();
    worker.thread = std::jthread([this, &worker](const std::stop_token& stop) { serve(stop, worker); });
  }
}

void WorkerPool::serve(const std::stop_token& stop, const Worker& worker) {
  while (!stop.stop_requested()) {
    std::optional<WorkList::Task> task;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [&] { return list_.waiting() > 0; });
      if (!stop.stop_requested()) task = list_.take();
    }
    if (!task) continue;
    try {
      const End end = carryOut(stop, worker, *task);
      if (end == End::kDone) continue;
      const std::scoped_lock lock(mutex_);
      if (end == End::kLost)
        options_.say(worker.name + " does not answer: " + task->name + " goes to another");
      end == End::kLost ? list_.lose(task->name) : list_.giveBack(task->name);
      changed_.notify_all();
    } catch (const std::exception& failure) {
      if (!stop.stop_requested()) fail(failure.what());
    }
    pause(stop, milliseconds(1000));
  }
}

WorkerPool::End WorkerPool::carryOut(const std::stop_token& stop, const Worker& worker,
                                     const WorkList::Task& given) {
  WorkList::Task task = given;
  auto answered = steady_clock::now();
  auto moved = answered;
  bool is_begun = false;
  int parts = 0;
  Ice::Long steps = 0;
  while (steady_clock::now() - answered < kSilence && steady_clock::now() - moved < kStandstill) {
    try {
      if (!is_begun) {
        worker.proxy->begin(task.name, task.text, task.parts);
        is_begun = true;
        parts = 0;
      }
      const avm::WorkReport report = worker.proxy->report(task.name, parts);
      answered = steady_clock::now();
      heard();
      if (std::exchange(steps, report.steps) != report.steps) moved = answered;
      if (report.state == avm::WorkState::Failed) {
        throw std::runtime_error(task.name + " at " + worker.name + ": " + report.text);
      }
      if (!report.text.empty()) {
        task.parts = report.text;
        parts = report.parts;
        keep(task, report.text, report.state == avm::WorkState::Done);
      }
      if (report.state == avm::WorkState::Done) return End::kDone;
    } catch (const avm::InvalidArgument& refusal) {
      throw std::runtime_error(worker.name + ": " + refusal.reason);
    } catch (const avm::Refused&) {
      heard();
      // Busy with somebody else's task; or it was started again and has forgotten this one.
      if (!std::exchange(is_begun, false)) return End::kBusy;
    } catch (const Ice::CommunicatorDestroyedException&) {
      return End::kBusy;
    } catch (const Ice::Exception&) {
      // Away, for now.
    }
    if (!pause(stop, kPoll)) return End::kBusy;
  }
  return End::kLost;
}

void WorkerPool::keep(const WorkList::Task& task, const std::string& result, bool is_whole) {
  const std::scoped_lock lock(mutex_);
  options_.store(task, result, is_whole);
  is_whole ? list_.finish(task.name) : list_.keepParts(task.name, result);
  changed_.notify_all();
}

void WorkerPool::heard() {
  const std::scoped_lock lock(mutex_);
  heard_ = steady_clock::now();
}

void WorkerPool::fail(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  if (failure_.empty()) failure_ = why;
  changed_.notify_all();
}

bool WorkerPool::pause(const std::stop_token& stop, milliseconds time) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, time, [] { return false; });
  return !stop.stop_requested();
}

}  // namespace vismem
