#include "mapper/app/map_builder.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

namespace vismem {
namespace {

/// The process ends: the map in the making is left.
struct Stopped {};

std::vector<std::string> linesOf(const nlohmann::json& summary, const char* name) {
  return summary.value(name, std::vector<std::string>{});
}

}  // namespace

MapBuilder::MapBuilder(Built built)
    : built_(std::move(built)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

PortReply MapBuilder::build(RecordedDrive drive, MapFilesOptions files) {
  {
    const std::lock_guard lock(mutex_);
    if (status_.building) return PortReply::rejected("another map is in the making");
    job_ = Job{std::move(drive), std::move(files)};
    status_.building = true;
    status_.progress = 0.0;
  }
  asked_.notify_all();
  return PortReply::accepted();
}

MapBuilderStatus MapBuilder::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void MapBuilder::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

BuiltMap MapBuilder::make(const std::stop_token& stop, const Job& job) {
  const auto begin = std::chrono::steady_clock::now();
  const auto progress = [&](double done_m, double all_m) {
    if (stop.stop_requested()) throw Stopped{};
    const std::lock_guard lock(mutex_);
    status_.progress = done_m / all_m;
  };
  BuiltMap made;
  if (!job.drive.record.keyframes.empty()) made.way_m = job.drive.record.keyframes.back().way_m;
  try {
    const DriveMap map = mapDrive(job.drive.record, job.drive.updates, job.drive.params, progress);
    const nlohmann::json summary = writeMapFiles(job.drive, map, job.files);
    made.file = summary.value("file", "");
    made.edges = summary.value("segments", 0);
    made.seen_again = summary.value("seen_again", 0);
    made.notes = linesOf(summary, "notes");
    made.problems = linesOf(summary, "problems");
  } catch (const std::exception& failure) {
    // A full disk, or an earlier map that cannot be used: the drive goes on.
    made.problems.emplace_back(failure.what());
  }
  made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

void MapBuilder::run(const std::stop_token& stop) {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);  // of this thread alone, on Linux
  std::unique_lock lock(mutex_);
  while (asked_.wait(lock, stop, [this] { return job_.has_value(); })) {
    const Job job = std::move(*std::exchange(job_, std::nullopt));
    lock.unlock();
    BuiltMap made;
    try {
      made = make(stop, job);
    } catch (const Stopped&) {
      return;
    }
    built_(made);
    lock.lock();
    status_.building = false;
    ++status_.built;
    status_.last = std::move(made);
  }
}

}  // namespace vismem
