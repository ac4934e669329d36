#include "common/tool/project_file.h"

#include <system_error>

namespace vismem {
namespace fs = std::filesystem;

fs::path projectFile(const fs::path& relative) {
  if (fs::exists(relative)) return relative;
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  for (fs::path folder = program.parent_path(); !failed && folder.has_relative_path();
       folder = folder.parent_path()) {
    if (fs::exists(folder / relative)) return folder / relative;
  }
  return relative;
}

}  // namespace vismem
