#include "localization/app/health_map_worker.h"

#include <exception>
#include <string>
#include <utility>

namespace vismem {
namespace {

/// The default message size of an Ice client (1 MB), and half a minute of computation.
constexpr HealthMapLimits kLimits{120'000.0, 5e6};

}  // namespace

HealthMapWorker::HealthMapWorker(const HealthMapParams& params, SegmentMap map_edges,
                                 std::function<MemoryUpdate()> newest)
    : params_(params),
      newest_(std::move(newest)),
      map_edges_(std::move(map_edges)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

HealthMapWorker::~HealthMapWorker() {
  stop();
}

std::string HealthMapWorker::check(const HealthMapRequest& request) const {
  const std::lock_guard lock(mutex_);
  return checkRequest(request, map_edges_, kLimits);
}

void HealthMapWorker::setMap(SegmentMap map_edges) {
  const std::lock_guard lock(mutex_);
  map_edges_ = std::move(map_edges);
  map_changed_ = true;
}

PortReply HealthMapWorker::draw(const HealthMapRequest& request, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) return PortReply::rejected("localization stops");
    if (jobs_.size() >= kMaximumJobs) {
      return PortReply::rejected(std::to_string(jobs_.size()) + " health maps are waiting already");
    }
    jobs_.push_back({request, std::move(done)});
  }
  changed_.notify_all();
  return PortReply::accepted();
}

void HealthMapWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void HealthMapWorker::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !jobs_.empty(); })) {
    const Job job = jobs_.front();
    lock.unlock();
    answer(stop, job);
    lock.lock();
    jobs_.pop_front();
  }
}

void HealthMapWorker::answer(const std::stop_token& stop, const Job& job) {
  std::optional<HealthMap> map;
  std::string why;
  const MemoryUpdate update = newest_();
  if (stop.stop_requested()) {
    why = "localization stops";
  } else if (!update.snapshot || !update.analysis) {
    why = "no observation yet";
  } else {
    try {
      {
        const std::lock_guard lock(mutex_);
        if (std::exchange(map_changed_, false)) mapper_.emplace(params_, map_edges_);
      }
      map = mapper_->map(update, job.request, [&stop] { return stop.stop_requested(); });
      if (!map) {
        why = stop.stop_requested() ? "localization stops"
                                    : "the newest observation has nothing that the map has a label for";
      }
    } catch (const std::exception& error) {
      why = std::string("a health map failed: ") + error.what();
    }
  }
  job.done(std::move(map), why);
}

}  // namespace vismem
