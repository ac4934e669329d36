#include "common/config/project_file.h"

namespace vismem {

namespace fs = std::filesystem;

fs::path projectFile(const fs::path& relative) {
  std::error_code failed;
  if (fs::exists(relative, failed)) return relative;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return relative;
  fs::path found = findUpwards(program.parent_path(), relative);
  // Installed programs have their data in share/vismem beside a folder above them.
  if (found.empty()) found = findUpwards(program.parent_path(), fs::path("share/vismem") / relative);
  return found.empty() ? relative : found;
}

fs::path findUpwards(fs::path folder, const fs::path& relative) {
  std::error_code ignored;
  for (; !folder.empty(); folder = folder.parent_path()) {
    if (fs::exists(folder / relative, ignored)) return folder / relative;
    if (!folder.has_relative_path()) break;
  }
  return {};
}

}  // namespace vismem
