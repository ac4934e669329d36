#include "common/image_codec/jpeg_header.h"

#include <cstddef>

namespace vismem {
namespace {

constexpr std::uint8_t kMark = 0xFF;
constexpr std::uint8_t kStartOfImage = 0xD8;
constexpr std::uint8_t kEndOfImage = 0xD9;
constexpr std::uint8_t kStartOfScan = 0xDA;

/// Frame headers are C0..CF without the tables (C4), the extension (C8) and the arithmetic conditioning (CC).
bool isFrameHeader(std::uint8_t code) {
  return code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
}

/// Marks that stand alone, without a length.
bool standsAlone(std::uint8_t code) {
  return code == 0x01 || (code >= 0xD0 && code <= 0xD7);
}

JpegHeader bad(std::string why) {
  JpegHeader header;
  header.error = std::move(why);
  return header;
}

bool endsWithEndMark(std::span<const std::uint8_t> bytes) {
  std::size_t end = bytes.size();
  while (end > 0 && bytes[end - 1] == 0) --end;
  return end >= 2 && bytes[end - 2] == kMark && bytes[end - 1] == kEndOfImage;
}

}  // namespace

JpegHeader readJpegHeader(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4 || bytes[0] != kMark || bytes[1] != kStartOfImage) return bad("is no JPEG file");
  JpegHeader header;
  std::size_t at = 2;
  while (true) {
    if (at + 4 > bytes.size()) return bad("is a JPEG file cut short in its header");
    if (bytes[at] != kMark) return bad("is a JPEG file with a broken header");
    const std::uint8_t code = bytes[at + 1];
    if (code == kMark || standsAlone(code)) {  // fill bytes may stand before a mark
      at += code == kMark ? 1 : 2;
      continue;
    }
    if (code == kStartOfScan) break;
    const std::size_t length = static_cast<std::size_t>(bytes[at + 2]) << 8 | bytes[at + 3];
    if (length < 2 || at + 2 + length > bytes.size()) return bad("is a JPEG file cut short in its header");
    if (isFrameHeader(code)) {
      if (length < 8) return bad("is a JPEG file with a broken header");
      header.height = bytes[at + 5] << 8 | bytes[at + 6];
      header.width = bytes[at + 7] << 8 | bytes[at + 8];
      header.components = bytes[at + 9];
    }
    at += 2 + length;
  }
  if (header.width < 1 || header.height < 1) return bad("is a JPEG file without a size");
  if (!endsWithEndMark(bytes)) return bad("is a JPEG file cut short");
  return header;
}

}  // namespace vismem
