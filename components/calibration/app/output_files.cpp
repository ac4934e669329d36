#include "calibration/app/output_files.h"

#include <fstream>
#include <stdexcept>

namespace vismem {

void writeWholeFile(const std::filesystem::path& file, const std::string& bytes) {
  std::error_code failure;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failure);
  std::filesystem::path unfinished = file;
  unfinished += ".new";
  std::ofstream stream(unfinished, std::ios::binary);
  stream << bytes;
  stream.close();
  if (stream) std::filesystem::rename(unfinished, file, failure);
  if (!stream || failure) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace vismem
