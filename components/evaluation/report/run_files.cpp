#include "evaluation/report/run_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "common/config/text_format.h"
#include "evaluation/core/trajectory_io.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

const fs::path& made(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": cannot make this folder: " + error.message());
  // Of a run before.
  fs::remove(folder / "truth.tum", error);
  return folder;
}

bool isSecondLater(const std::optional<StampUs>& last_us, StampUs stamp_us) {
  return !last_us || std::abs(stamp_us - *last_us) >= kSecondUs;
}

}  // namespace

GrowingFile::GrowingFile(fs::path file, std::string_view header)
    : file_(std::move(file)), out_(file_, std::ios::binary) {
  out_ << header;
  flush();
}

void GrowingFile::write(const std::function<void(std::ostream&)>& rows) {
  if (!problem_.empty()) return;
  rows(out_);
  check();
}

void GrowingFile::flush() {
  if (!problem_.empty()) return;
  out_.flush();
  check();
}

void GrowingFile::check() {
  if (!out_) problem_ = "cannot write " + file_.string() + ": " + std::strerror(errno);
}

RunFiles::RunFiles(const fs::path& folder, bool snapshots)
    : folder_(made(folder)),
      snapshots_(snapshots),
      trajectory_{{folder / "trajectory.tum", kTumHeader}, {}},
      odometry_{{folder / "odometry.tum", kTumHeader}, {}},
      races_(folder / "races.csv", kRacesHeader),
      memory_(folder / "memory.csv", kMemoryHeader),
      primitives_(folder / "primitives.csv", kPrimitivesHeader) {
  if (const auto found = problems(); !found.empty()) throw std::runtime_error(joined(found, "\n"));
}

void RunFiles::add(Poses& poses, const StampedPose& pose) {
  if (poses.last_us && pose.stamp_us <= *poses.last_us) return;
  poses.last_us = pose.stamp_us;
  poses.file.write([&](std::ostream& out) { writeTumRow(pose, out); });
  flushEachSecond(pose.stamp_us);
}

void RunFiles::addPose(const StampedPose& T_world_robot) {
  add(trajectory_, T_world_robot);
}
void RunFiles::addOdometry(const StampedPose& T_odom_robot) {
  add(odometry_, T_odom_robot);
}
void RunFiles::addTruth(const StampedPose& T_world_robot) {
  if (!truth_) truth_.emplace(Poses{{folder_ / "truth.tum", kTumHeader}, {}});
  add(*truth_, T_world_robot);
}

void RunFiles::addEstimate(const PoseEstimate& estimate) {
  races_.write([&](std::ostream& out) { writeRacesRows(estimate, out); });
}

void RunFiles::addMemory(const MemorySnapshot& memory) {
  if (snapshots_ && isSecondLater(written_memory_us_, memory.stamp_us)) write(memory);
}

void RunFiles::write(const MemorySnapshot& memory) {
  written_memory_us_ = memory.stamp_us;
  memory_.write([&](std::ostream& out) { writeMemoryRows(memory, out); });
  primitives_.write([&](std::ostream& out) { writePrimitivesRows(memory, out); });
}

void RunFiles::flushEachSecond(StampUs stamp_us) {
  if (!isSecondLater(flushed_us_, stamp_us)) return;
  flushed_us_ = stamp_us;
  for (GrowingFile* file : {&trajectory_.file, &odometry_.file, &races_, &memory_, &primitives_})
    file->flush();
  if (truth_) truth_->file.flush();
}

void RunFiles::finish(const MemorySnapshot* memory) {
  if (memory != nullptr && memory->stamp_us != written_memory_us_) write(*memory);
  flushed_us_.reset();
  flushEachSecond(0);
}

std::vector<const GrowingFile*> RunFiles::files() const {
  std::vector<const GrowingFile*> all{&trajectory_.file, &odometry_.file, &races_, &memory_, &primitives_};
  if (truth_) all.push_back(&truth_->file);
  return all;
}

std::vector<std::string> RunFiles::problems() const {
  std::vector<std::string> found;
  for (const GrowingFile* file : files()) {
    if (!file->problem().empty()) found.push_back(file->problem());
  }
  return found;
}

}  // namespace vismem
