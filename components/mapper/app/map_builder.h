/// @file The thread that makes maps of a drive while it goes on. No Ice. See B6.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "common/robot/ports.h"
#include "mapper/app/map_files.h"
#include "mapper/core/mapper_status.h"

namespace vismem {

/// Makes one map at a time, with less of the processor than the rest of the robot asks for. *Thread-safe.*
class MapBuilder {
 public:
  /// Called by the builder's thread.
  using Built = std::function<void(const BuiltMap&)>;

  explicit MapBuilder(Built built);
  ~MapBuilder() { stop(); }

  /// @return rejected while another map is in the making.
  PortReply build(RecordedDrive drive, MapFilesOptions files);
  MapBuilderStatus status() const;
  /// Leaves a map in the making at its next search for closings, or after the solve under way.
  void stop();

 private:
  struct Job {
    RecordedDrive drive;
    MapFilesOptions files;
  };
  void run(const std::stop_token& stop);
  BuiltMap make(const std::stop_token& stop, const Job& job);

  const Built built_;
  mutable std::mutex mutex_;
  std::condition_variable_any asked_;
  std::optional<Job> job_;
  MapBuilderStatus status_;
  std::jthread thread_;  ///< last member: it uses all of the above
};

}  // namespace vismem
