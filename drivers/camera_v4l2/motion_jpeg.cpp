#include "drivers/camera_v4l2/motion_jpeg.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/image_codec/image_codec.h"

namespace vismem::v4l2 {
namespace {

constexpr std::uint8_t kMark = 0xFF;
constexpr std::uint8_t kTables = 0xC4;
constexpr std::uint8_t kStartOfScan = 0xDA;
constexpr std::uint8_t kEndOfImage = 0xD9;

/// Calls `visit(code, begin, end)` for each segment of a header, up to the start of the scan.
/// @return where the scan starts; empty if the header is broken.
template <typename Visit>
std::optional<std::size_t> walkHeader(const std::vector<std::uint8_t>& bytes, Visit&& visit) {
  if (bytes.size() < 4 || bytes[0] != kMark || bytes[1] != 0xD8) return std::nullopt;
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && bytes[at] == kMark) {
    if (bytes[at + 1] == kMark) {  // fill bytes may stand before a mark
      ++at;
      continue;
    }
    if (bytes[at + 1] == kStartOfScan) return at;
    const std::size_t end = at + 2 + (static_cast<std::size_t>(bytes[at + 2]) << 8U | bytes[at + 3]);
    if (end > bytes.size()) return std::nullopt;
    visit(bytes[at + 1], at, end);
    at = end;
  }
  return std::nullopt;
}

/// The standard Huffman tables as segments, which encoders without tables of their own use.
const std::vector<std::uint8_t>& standardTables() {
  static const std::vector<std::uint8_t> tables = [] {
    const std::vector<std::uint8_t> file = encodeJpeg(cv::Mat::zeros(16, 16, CV_8UC3), 90);
    std::vector<std::uint8_t> found;
    walkHeader(file, [&](std::uint8_t code, std::size_t begin, std::size_t end) {
      if (code == kTables)
        found.insert(found.end(), file.begin() + static_cast<std::ptrdiff_t>(begin),
                     file.begin() + static_cast<std::ptrdiff_t>(end));
    });
    return found;
  }();
  return tables;
}

}  // namespace

void completeJpeg(std::vector<std::uint8_t>& bytes) {
  bool has_tables = false;
  const auto scan =
      walkHeader(bytes, [&](std::uint8_t code, std::size_t, std::size_t) { has_tables |= code == kTables; });
  if (!scan) return;
  constexpr std::array kEnd{kMark, kEndOfImage};
  const auto data = bytes.begin() + static_cast<std::ptrdiff_t>(*scan);
  if (const auto end = std::find_end(data, bytes.end(), kEnd.begin(), kEnd.end()); end != bytes.end()) {
    bytes.erase(end + kEnd.size(), bytes.end());
  }
  if (!has_tables) {
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(*scan), standardTables().begin(),
                 standardTables().end());
  }
}

}  // namespace vismem::v4l2
