#include "drivers/camera_files/image_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "common/image_codec/image_codec.h"
#include "common/image_codec/jpeg_header.h"
#include "common/robot/ports.h"
#include "drivers/camera_files/natural_order.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStampFile = "stamps.txt";

std::optional<std::vector<std::uint8_t>> bytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) return std::nullopt;
  return bytes;
}

PictureResult pictureOf(const fs::path& file, std::optional<StampUs> own_us) {
  auto bytes = bytesOf(file);
  if (!bytes) return PictureResult::lost(file.string() + ": cannot be read");
  Picture picture;
  picture.own_us = own_us;
  picture.name = file.string();
  const JpegHeader header = readJpegHeader(*bytes);
  if (header.error.empty() && std::max(header.width, header.height) <= kMaxImageSide_px) {
    picture.native = std::make_shared<NativeImage>(
        NativeImage{NativeFormat::kJpeg, header.width, header.height, 0, std::move(*bytes)});
  } else {
    DecodedImage decoded = decodeImageFile(*bytes);
    if (!decoded.error.empty()) return PictureResult::lost(file.string() + ": " + decoded.error);
    picture.image = std::move(decoded.image);
  }
  return {PictureResult::Kind::kPicture, std::move(picture), {}};
}

/// "12.5 a.png" -> 12'500'000 and a.png; empty if it is anything else.
std::optional<std::pair<StampUs, std::string>> parseStampLine(std::string_view line) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!line.empty() && blank(line.back())) line.remove_suffix(1);
  double seconds = 0.0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), seconds);
  if (error != std::errc() || !(std::abs(seconds) < 1e12)) return std::nullopt;
  std::string_view name(end, static_cast<std::size_t>(line.data() + line.size() - end));
  if (name.empty() || !blank(name.front())) return std::nullopt;
  while (!name.empty() && blank(name.front())) name.remove_prefix(1);
  if (name.empty()) return std::nullopt;
  return std::pair(toStampUs(seconds), std::string(name));
}

}  // namespace

bool isImageName(const fs::path& file) {
  static constexpr std::array kEndings = {".jpg", ".jpeg", ".png", ".bmp",  ".pgm",
                                          ".ppm", ".pnm",  ".tif", ".tiff", ".webp"};
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

std::string ImageFolder::name() const {
  return (isImageName(path_) ? "image " : "image folder ") + path_.string();
}

std::string ImageFolder::open() {
  entries_.clear();
  next_ = read_ = 0;
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  const std::string missing = path_.string() + ": no such file or folder";
  if (!fs::exists(status)) return missing;
  if (!fs::is_directory(status)) {
    entries_.push_back({path_, std::nullopt});
    return {};
  }
  const fs::path stamps = path_ / kStampFile;
  if (fs::exists(stamps, error)) return readStamps(stamps);
  for (fs::directory_iterator it(path_, error), end; !error && it != end; it.increment(error)) {
    const fs::path& file = it->path();
    if (!isImageName(file) || file.filename().string().starts_with('.')) continue;
    std::error_code ignored;
    if (it->is_regular_file(ignored)) entries_.push_back({file, std::nullopt});
  }
  // It may disappear between the two checks.
  if (error == std::errc::no_such_file_or_directory) return missing;
  if (error) return path_.string() + ": " + error.message();
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return naturallyBefore(a.file.filename().string(), b.file.filename().string());
  });
  return entries_.empty() ? path_.string() + ": the folder holds no image" : std::string();
}

std::string ImageFolder::readStamps(const fs::path& file) {
  std::ifstream in(file);
  if (!in) return file.string() + ": cannot be read";
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const std::string where = file.string() + ":" + std::to_string(number) + ": ";
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    auto stamp_and_name = parseStampLine(line);
    if (!stamp_and_name) return where + "\"" + line + "\" (must be SECONDS FILE)";
    auto& [stamp_us, name] = *stamp_and_name;
    if (!entries_.empty() && stamp_us <= *entries_.back().stamp_us) {
      return where + "the stamp is not after the one before it";
    }
    entries_.push_back({path_ / name, stamp_us});
  }
  return entries_.empty() ? file.string() + ": names no image" : std::string();
}

PictureResult ImageFolder::read() {
  if (next_ < entries_.size()) {
    const Entry& entry = entries_[next_++];
    PictureResult result = pictureOf(entry.file, entry.stamp_us);
    if (result.kind == PictureResult::Kind::kPicture) {
      ++read_;
    } else if (std::error_code error; !fs::exists(path_, error)) {
      return PictureResult::away(path_.string() + ": it has gone");
    }
    return result;
  }
  // A restart without any readable image would be an endless loop.
  if (read_ == 0) return PictureResult::away(path_.string() + ": none of its images can be read");
  return PictureResult::end();
}

double ImageFolder::ownRate_hz() const {
  if (entries_.size() < 2 || !entries_.front().stamp_us) return 0.0;
  const double seconds = toSeconds(*entries_.back().stamp_us - *entries_.front().stamp_us);
  return static_cast<double>(entries_.size() - 1) / seconds;
}

}  // namespace vismem
