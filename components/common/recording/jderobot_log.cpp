#include "common/recording/jderobot_log.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMillisecondUs = 1000;
/// No log lasts longer: thirty years.
constexpr std::int64_t kMostMs = 1'000'000'000'000;
constexpr std::size_t kEncoderBytes = 5 * sizeof(float);

std::optional<std::string> readFile(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Stamps of a .jde file in their order, each once.
std::vector<std::int64_t> stampsOf(const fs::path& file, JdeRobotLog& log) {
  const auto text = readFile(file);
  if (!text) return {};
  std::size_t wrong = 0;
  auto stamps = parseJdeStamps(*text, wrong);
  if (wrong > 0)
    log.notes.push_back(file.string() + ": " + std::to_string(wrong) + " lines are no number: left out");
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  return stamps;
}

std::optional<JdeRobotLog::Odometry> readEncoders(const fs::path& file, std::int64_t stamp_us) {
  static_assert(std::endian::native == std::endian::little, "JdeRobot wrote its floats on x86");
  const auto bytes = readFile(file);
  if (!bytes || bytes->size() != kEncoderBytes) return std::nullopt;
  std::array<float, 5> values{};
  std::memcpy(values.data(), bytes->data(), kEncoderBytes);
  const JdeRobotLog::Odometry sample{stamp_us, 1e-3 * static_cast<double>(values[0]),
                                     1e-3 * static_cast<double>(values[1]),
                                     static_cast<double>(values[2]) * std::numbers::pi / 180.0};
  if (!std::isfinite(sample.x_m) || !std::isfinite(sample.y_m) || !std::isfinite(sample.theta_rad))
    return std::nullopt;
  return sample;
}

void readImages(const fs::path& folder, JdeRobotLog& log) {
  std::size_t missing = 0;
  for (const std::int64_t ms : stampsOf(folder / "cameraData.jde", log)) {
    const fs::path name = folder / std::to_string(ms);
    bool found = false;
    for (const auto& [ending, format] :
         {std::pair(".png", "png"), std::pair(".jpg", "jpeg"), std::pair(".jpeg", "jpeg")}) {
      const fs::path file = name.string() + ending;
      std::error_code error;
      if (!fs::is_regular_file(file, error)) continue;
      log.images.push_back({ms * kMillisecondUs, file, format});
      found = true;
      break;
    }
    missing += found ? 0 : 1;
  }
  if (missing > 0) {
    log.notes.push_back(
        folder.string() + ": " + std::to_string(missing) +
        " images that cameraData.jde names are not there (expected MILLISECONDS.png or .jpg)");
  }
}

void readOdometry(const fs::path& folder, JdeRobotLog& log) {
  std::error_code error;
  std::vector<fs::path> parts;
  for (const auto& item : fs::directory_iterator(folder, error)) parts.push_back(item.path());
  std::sort(parts.begin(), parts.end());
  if (parts.empty()) {
    log.notes.push_back(folder.string() + ": no odometry (expected encoder1/encoderData.jde)");
    return;
  }
  if (parts.size() > 1)
    log.notes.push_back(folder.string() + ": several encoders: " + parts.front().string() + " is taken");
  std::size_t wrong = 0;
  for (const std::int64_t ms : stampsOf(parts.front() / "encoderData.jde", log)) {
    if (const auto sample = readEncoders(parts.front() / std::to_string(ms), ms * kMillisecondUs)) {
      log.odometry.push_back(*sample);
    } else {
      ++wrong;
    }
  }
  if (wrong > 0) {
    log.notes.push_back(
        parts.front().string() + ": " + std::to_string(wrong) +
        " samples are left out (expected files of 20 bytes: x, y, theta, cosine, sine as floats)");
  }
}

}  // namespace

std::vector<std::int64_t> parseJdeStamps(const std::string& text, std::size_t& wrong) {
  std::vector<std::int64_t> stamps;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty()) continue;
    std::int64_t ms = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), ms);
    if (error != std::errc{} || end != line.data() + line.size() || ms < 0 || ms > kMostMs) {
      ++wrong;
    } else {
      stamps.push_back(ms);
    }
  }
  return stamps;
}

JdeRobotLog readJdeRobotLog(const fs::path& folder, int camera) {
  const fs::path images = folder / "images" / ("camera" + std::to_string(camera));
  std::error_code error;
  if (!fs::is_regular_file(images / "cameraData.jde", error)) {
    throw ConfigError({folder.string() + ": no log of JdeRobot's recorder: found no " +
                       (images / "cameraData.jde").string()});
  }
  JdeRobotLog log;
  readImages(images, log);
  if (log.images.empty()) throw RecordingError(images.string() + ": none of its images is there");
  readOdometry(folder / "encoders", log);
  return log;
}

}  // namespace vismem
