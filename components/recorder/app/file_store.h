/// @file Recordings as folders of bags.
#pragma once

#include <filesystem>
#include <functional>

#include "recorder/core/recorder_core.h"

namespace vismem {

/// FOLDER/NAME/NAME_0000.bag, NAME_0001.bag ...; the part that is being written ends with ".bag.active".
/// *Single-threaded.*
class FileStore : public RecordingStore {
 public:
  /// Called with the folder of each new recording, before its first part is made: to put a session's other
  /// files there.
  using Made = std::function<void(const std::filesystem::path& folder)>;

  /// @param durable whether each chunk waits for the disk.
  FileStore(std::filesystem::path folder, bool durable, Made made = {});

  std::unique_ptr<PartStore> create(const std::string& name) override;
  std::string pathOf(const std::string& name) const override;

 private:
  const std::filesystem::path folder_;
  const bool durable_;
  const Made made_;
};

}  // namespace vismem
