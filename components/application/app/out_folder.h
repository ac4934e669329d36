/// @file The folder for the results of a run.
#pragma once

#include <filesystem>
#include <vector>

namespace vismem {

/// Makes the folder with those above it, and at its end removes those of them that stayed empty: a run that
/// did not begin leaves none. *Single-threaded.*
class OutFolder {
 public:
  /// @throws UsageError when it cannot be made or nothing can be written into it.
  explicit OutFolder(const std::filesystem::path& folder);
  ~OutFolder();
  OutFolder(const OutFolder&) = delete;
  OutFolder& operator=(const OutFolder&) = delete;

  /// Removes what the run has put there, if the folder is its own.
  void discard();

 private:
  std::vector<std::filesystem::path> made_;  ///< the innermost first
};

}  // namespace vismem
