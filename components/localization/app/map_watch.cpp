#include "localization/app/map_watch.h"

#include <system_error>
#include <utility>

namespace vismem {
namespace {

constexpr std::chrono::seconds kPeriod{1};

}  // namespace

MapWatch::MapWatch(std::vector<std::filesystem::path> files) : files_(std::move(files)) {
  std::erase_if(files_, [](const std::filesystem::path& file) { return file.empty(); });
  known_ = last_ = read();
}

MapWatch::Signs MapWatch::read() const {
  Signs signs;
  for (const auto& file : files_) {
    std::error_code failed;
    Sign sign{std::filesystem::last_write_time(file, failed), 0};
    if (!failed) sign.size = std::filesystem::file_size(file, failed);
    signs.push_back(failed ? std::nullopt : std::optional<Sign>(sign));
  }
  return signs;
}

bool MapWatch::hasChanged(Clock::time_point now) {
  if (checked_ && now - *checked_ < kPeriod) return false;
  checked_ = now;
  Signs signs = read();
  const bool settled = signs == last_;
  last_ = signs;
  if (!settled || signs == known_) return false;
  known_ = std::move(signs);
  return true;
}

}  // namespace vismem
