/// @file What lies beside the bags of a recording, so that it can be replayed and evaluated without anything
/// else: configurations, map, palette, versions.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace vismem {

/// Fills FOLDER/NAME: session.json, cfg/COMPONENT.cfg (the effective configuration of every component that
/// was reached, also later), map.csv and map.palette. *Thread-safe.*
class SessionFolder {
 public:
  using Settings = std::vector<std::pair<std::string, std::string>>;  ///< keys and values

  /// @param map empty: none. @param version of this build.
  SessionFolder(std::filesystem::path map, std::string version)
      : map_(std::move(map)), version_(std::move(version)) {}

  /// A new recording: all that is known is written there, and from now on what becomes known.
  /// @throws RecordingError.
  void open(const std::filesystem::path& folder);
  /// @param version of the component.
  void add(const std::string& component, const std::string& version, Settings settings);

 private:
  void writeLocked() const;

  const std::filesystem::path map_;
  const std::string version_;
  std::mutex mutex_;
  std::filesystem::path folder_;
  std::string started_;  ///< local time
  std::map<std::string, std::pair<std::string, Settings>> components_;
};

/// A configuration as a .cfg file's text, which Properties::parse reads back.
std::string configurationFile(const SessionFolder::Settings& settings);

}  // namespace vismem
