/// @file Notices that the files of a map have changed. See C3.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace vismem {

/// Compares size and time of modification of some files, at most once per second. *Single-threaded.*
class MapWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// The files as they are now are the known ones. Empty paths are left out.
  explicit MapWatch(std::vector<std::filesystem::path> files);

  /// Whether the files differ from the known ones and were the same at the check before: a file is not read
  /// while it is written. The files are known from then on.
  bool hasChanged(Clock::time_point now);

 private:
  struct Sign {
    std::filesystem::file_time_type time;
    std::uintmax_t size = 0;
    bool operator==(const Sign&) const = default;
  };
  using Signs = std::vector<std::optional<Sign>>;  ///< empty: no such file
  Signs read() const;

  std::vector<std::filesystem::path> files_;
  Signs known_;
  Signs last_;
  std::optional<Clock::time_point> checked_;
};

}  // namespace vismem
