#include "application/app/out_folder.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "application/app/options.h"

namespace vismem {

namespace fs = std::filesystem;

OutFolder::OutFolder(const fs::path& folder) {
  std::error_code error;
  for (fs::path part = folder; !part.empty() && !fs::exists(part, error); part = part.parent_path())
    made_.push_back(part);
  fs::create_directories(folder, error);
  if (error) throw UsageError("--out " + folder.string() + ": cannot make this folder: " + error.message());
  if (!fs::is_directory(folder)) throw UsageError("--out " + folder.string() + ": not a folder");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw UsageError("--out " + folder.string() + ": cannot write into this folder: " + std::strerror(errno));
}

OutFolder::~OutFolder() {
  std::error_code not_empty;
  for (const fs::path& folder : made_) fs::remove(folder, not_empty);
}

void OutFolder::discard() {
  std::error_code ignored;
  if (!made_.empty()) fs::remove_all(made_.front(), ignored);
}

}  // namespace vismem
