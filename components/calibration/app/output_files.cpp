#include "calibration/app/output_files.h"

#include "common/tool/replace_file.h"

namespace vismem {

void writeWholeFile(const std::filesystem::path& file, const std::string& bytes) {
  std::error_code failure;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
  replaceFile(file, bytes);
}

}  // namespace vismem
