#include "experiments/ice/worker_servant.h"

#include <exception>
#include <utility>

namespace vismem {
namespace {

constexpr std::size_t kLongestId = 200;
constexpr std::size_t kLongestTask_bytes = std::size_t{1} << 20;

/// Ends a task in whose place another one came.
struct Replaced {};

}  // namespace

void WorkerServant::serve(const std::stop_token& stop, const std::function<void()>& progress,
                          const std::function<void(const std::string&, const std::string&)>& finished) {
  while (!stop.stop_requested()) {
    progress();
    Job job;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait_for(lock, stop, std::chrono::seconds(1), [this] { return job_.is_new; })) continue;
      job_.is_new = false;
      job = job_;
    }
    run(stop, job, progress, finished);
  }
}

void WorkerServant::run(const std::stop_token& stop, const Job& job, const std::function<void()>& progress,
                        const std::function<void(const std::string&, const std::string&)>& finished) {
  const auto store = [&](avm::WorkState state, std::string text) {
    const std::scoped_lock lock(mutex_);
    if (job_.id != job.id) return;
    job_.report.state = state;
    job_.report.text = std::move(text);
    if (state == avm::WorkState::Working) ++job_.report.parts;
  };
  try {
    store(avm::WorkState::Done,
          skill_.run(
              job.task, job.parts,
              [&] {
                look(stop, job.id);
                progress();
              },
              [&](const std::string& parts) { store(avm::WorkState::Working, parts); }));
    finished(job.id, "");
  } catch (const Replaced&) {
    finished(job.id, "another task took its place");
  } catch (const std::exception& failure) {
    store(avm::WorkState::Failed, failure.what());
    finished(job.id, failure.what());
  }
}

void WorkerServant::look(const std::stop_token& stop, const std::string& id) {
  const std::scoped_lock lock(mutex_);
  if (stop.stop_requested() || job_.id != id) throw Replaced();
  ++job_.report.steps;
}

void WorkerServant::begin(std::string id, std::string task, std::string parts, const Ice::Current&) {
  if (id.empty() || id.size() > kLongestId) throw avm::InvalidArgument("id: must have 1..200 characters");
  if (task.size() > kLongestTask_bytes) throw avm::InvalidArgument("task: must have at most 1 MB");
  if (const std::string problem = skill_.problem(task); !problem.empty()) {
    throw avm::InvalidArgument("task: " + problem);
  }
  const auto now = std::chrono::steady_clock::now();
  const std::scoped_lock lock(mutex_);
  if (job_.id == id) {
    job_.asked = now;
    return;
  }
  const bool is_working = !job_.id.empty() && job_.report.state == avm::WorkState::Working;
  if (is_working && now - job_.asked < kForgotten) throw avm::Refused("busy with " + job_.id);
  job_ = {std::move(id), std::move(task), std::move(parts), true, {avm::WorkState::Working, 0, 0, ""}, now};
  changed_.notify_all();
}

avm::WorkReport WorkerServant::report(std::string id, int known_parts, const Ice::Current&) {
  const std::scoped_lock lock(mutex_);
  if (job_.id != id) throw avm::Refused("no task " + id + " here");
  job_.asked = std::chrono::steady_clock::now();
  avm::WorkReport report = job_.report;
  if (report.state == avm::WorkState::Working && report.parts <= known_parts) report.text.clear();
  return report;
}

}  // namespace vismem
