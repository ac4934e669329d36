/// @file The text files of a run, written as it goes.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/trajectory.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// A text file that grows. The first failure is kept; what comes after it is dropped. *Single-threaded.*
class GrowingFile {
 public:
  /// Makes the file, or empties it, and writes its first line.
  GrowingFile(std::filesystem::path file, std::string_view header);

  void write(const std::function<void(std::ostream&)>& rows);
  /// Hands what was written to the system.
  void flush();
  /// "cannot write FILE: REASON"; empty while all went well.
  const std::string& problem() const { return problem_; }

 private:
  void check();

  std::filesystem::path file_;
  std::ofstream out_;
  std::string problem_;
};

/// trajectory.tum, odometry.tum, races.csv, memory.csv, primitives.csv, and truth.tum once a true pose comes.
/// What was added more than a second of the robot's time ago is on the disk. A file that fails does not stop
/// the others. *Single-threaded.*
class RunFiles {
 public:
  /// Makes the folder and its files, so that a wrong place shows before the run.
  /// @param snapshots the memory of each second goes into memory.csv and primitives.csv, beside the last one.
  /// @throws std::runtime_error with every file that cannot be written.
  explicit RunFiles(const std::filesystem::path& folder, bool snapshots = false);

  // Poses that are not newer than the last one of their file are left out.
  void addPose(const StampedPose& T_world_robot);
  void addOdometry(const StampedPose& T_odom_robot);
  void addTruth(const StampedPose& T_world_robot);
  void addEstimate(const PoseEstimate& estimate);
  void addMemory(const MemorySnapshot& memory);

  /// Writes the last memory and hands all to the system.
  /// @param memory null: there was none.
  void finish(const MemorySnapshot* memory);
  /// One line for each file that failed.
  std::vector<std::string> problems() const;

 private:
  struct Poses {
    GrowingFile file;
    std::optional<StampUs> last_us;
  };
  void add(Poses& poses, const StampedPose& pose);
  void write(const MemorySnapshot& memory);
  void flushEachSecond(StampUs stamp_us);
  std::vector<const GrowingFile*> files() const;

  const std::filesystem::path folder_;
  const bool snapshots_;
  Poses trajectory_;
  Poses odometry_;
  std::optional<Poses> truth_;
  GrowingFile races_;
  GrowingFile memory_;
  GrowingFile primitives_;
  std::optional<StampUs> written_memory_us_;
  std::optional<StampUs> flushed_us_;
};

}  // namespace vismem
