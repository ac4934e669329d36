#include "simulator/core/world_tga.h"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace vismem {
namespace {

constexpr std::size_t kHeader_bytes = 18;
constexpr long kMaxPicture_px = 1L << 27;
constexpr int kRunLengthEncoded = 8;
constexpr int kFromRight = 0x10;
constexpr int kFromTop = 0x20;

enum Kind { kMapped = 1, kColour = 2, kGrey = 3 };

struct Header {
  int id_bytes = 0;
  int map_entries = 0;
  int map_first = 0;
  int map_bits = 0;
  int kind = 0;
  bool encoded = false;
  int width = 0;
  int height = 0;
  int bits = 0;
  bool from_right = false;
  bool from_top = false;
};

std::optional<Header> readHeader(std::string_view bytes) {
  if (bytes.size() < kHeader_bytes) return std::nullopt;
  const auto byte = [&](std::size_t i) { return static_cast<int>(static_cast<std::uint8_t>(bytes[i])); };
  const auto word = [&](std::size_t i) { return byte(i) | byte(i + 1) << 8; };
  Header h;
  h.id_bytes = byte(0);
  const bool has_map = byte(1) == 1;
  h.kind = byte(2) & ~kRunLengthEncoded;
  h.encoded = (byte(2) & kRunLengthEncoded) != 0;
  h.map_first = word(3);
  h.map_entries = has_map ? word(5) : 0;
  h.map_bits = has_map ? byte(7) : 0;
  h.width = word(12);
  h.height = word(14);
  h.bits = byte(16);
  h.from_right = (byte(17) & kFromRight) != 0;
  h.from_top = (byte(17) & kFromTop) != 0;
  const auto isColour = [](int bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; };
  const bool known = (h.kind == kMapped && h.bits == 8 && has_map && isColour(h.map_bits)) ||
                     (h.kind == kColour && isColour(h.bits)) || (h.kind == kGrey && h.bits == 8);
  const long pixels = static_cast<long>(h.width) * h.height;
  if (!known || byte(1) > 1 || pixels < 1 || pixels > kMaxPicture_px) return std::nullopt;
  return h;
}

cv::Vec3b colourAt(const char* p, int bits) {
  const auto byte = [p](int i) { return static_cast<std::uint8_t>(p[i]); };
  if (bits == 8) return {byte(0), byte(0), byte(0)};
  if (bits >= 24) return {byte(0), byte(1), byte(2)};
  const int value = byte(0) | byte(1) << 8;
  const auto channel = [value](int shift) {
    return static_cast<std::uint8_t>(((value >> shift) & 31) * 255 / 31);
  };
  return {channel(0), channel(5), channel(10)};
}

/// The pixels of a picture one by one, in the order of the file.
class PixelStream {
 public:
  PixelStream(const Header& header, std::string_view bytes)
      : header_(header),
        colour_map_(bytes.substr(std::min(bytes.size(), kHeader_bytes + header.id_bytes))),
        rest_(colour_map_.substr(std::min(colour_map_.size(), mapBytes()))) {}

  /// @return empty at the end of the bytes.
  std::optional<cv::Vec3b> next() {
    const std::size_t size = sizeOf(header_.bits);
    if (header_.encoded && left_ == 0) {
      if (rest_.empty()) return std::nullopt;
      const auto packet = static_cast<std::uint8_t>(rest_.front());
      rest_.remove_prefix(1);
      left_ = (packet & 0x7F) + 1;
      repeats_ = (packet & 0x80) != 0;
    }
    if (rest_.size() < size) return std::nullopt;
    const auto pixel = valueAt(rest_.data());
    if (header_.encoded) --left_;
    if (!header_.encoded || !repeats_ || left_ == 0) rest_.remove_prefix(size);
    return pixel;
  }

 private:
  static std::size_t sizeOf(int bits) { return static_cast<std::size_t>(bits + 7) / 8; }
  std::size_t mapBytes() const {
    return static_cast<std::size_t>(header_.map_entries) * sizeOf(header_.map_bits);
  }
  std::optional<cv::Vec3b> valueAt(const char* p) const {
    if (header_.kind != kMapped) return colourAt(p, header_.bits);
    const int index = static_cast<std::uint8_t>(*p) - header_.map_first;
    const std::size_t size = sizeOf(header_.map_bits);
    if (index < 0 || index >= header_.map_entries || colour_map_.size() < (index + 1) * size)
      return std::nullopt;
    return colourAt(colour_map_.data() + index * size, header_.map_bits);
  }

  Header header_;
  std::string_view colour_map_;
  std::string_view rest_;
  int left_ = 0;
  bool repeats_ = false;
};

}  // namespace

cv::Mat decodeTga(std::string_view bytes) {
  const auto header = readHeader(bytes);
  if (!header) return {};
  // A run of 128 pixels takes two bytes or more.
  if (static_cast<std::size_t>(header->width) * header->height > 64 * bytes.size()) return {};
  cv::Mat picture(header->height, header->width, CV_8UC3);
  PixelStream pixels(*header, bytes);
  for (int row = 0; row < header->height; ++row) {
    const int y = header->from_top ? row : header->height - 1 - row;
    for (int column = 0; column < header->width; ++column) {
      const auto pixel = pixels.next();
      if (!pixel) return {};
      picture.at<cv::Vec3b>(y, header->from_right ? header->width - 1 - column : column) = *pixel;
    }
  }
  return picture;
}

}  // namespace vismem
