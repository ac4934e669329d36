#include "common/process/name_by_date.h"

#include <ctime>

namespace vismem {

std::string nameByDate() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", &local);
  return text;
}

std::string unusedNameByDate(const std::filesystem::path& folder, const std::string& prefix) {
  const std::string first = prefix + nameByDate();
  std::string name = first;
  std::error_code error;  // a folder that cannot be read has no such name
  for (int copy = 2; std::filesystem::exists(folder / name, error); ++copy)
    name = first + "-" + std::to_string(copy);
  return name;
}

}  // namespace vismem
