#include "common/recording/bag_format.h"

#include <algorithm>

namespace vismem {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

ByteView view(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

std::uint32_t readU32(const std::uint8_t* b) {
  return static_cast<std::uint32_t>(b[0]) | static_cast<std::uint32_t>(b[1]) << 8 |
         static_cast<std::uint32_t>(b[2]) << 16 | static_cast<std::uint32_t>(b[3]) << 24;
}

std::uint64_t readU64(const std::uint8_t* b) {
  return readU32(b) | static_cast<std::uint64_t>(readU32(b + 4)) << 32;
}

void appendU32(Bytes& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void appendTime(Bytes& out, std::int64_t time_ns) {
  const std::int64_t last_ns = (std::int64_t{1} << 32) * kSecondNs - 1;
  const std::int64_t bounded_ns = std::clamp<std::int64_t>(time_ns, 0, last_ns);
  appendU32(out, static_cast<std::uint32_t>(bounded_ns / kSecondNs));
  appendU32(out, static_cast<std::uint32_t>(bounded_ns % kSecondNs));
}

std::int64_t toStampOfTime(std::int64_t time_ns) {
  return (time_ns + 500) / 1000;
}

std::int64_t toTimeNs(std::int64_t stamp_us) {
  constexpr std::int64_t kLast_us = (std::int64_t{1} << 32) * 1'000'000 - 1;
  return std::clamp<std::int64_t>(stamp_us, 0, kLast_us) * 1000;
}

std::optional<RecordFields> RecordFields::parse(ByteView bytes) {
  RecordFields result;
  std::size_t at = 0;
  while (at < bytes.size()) {
    if (bytes.size() - at < 4) return std::nullopt;
    const std::size_t size = readU32(bytes.data() + at);
    at += 4;
    if (size > bytes.size() - at) return std::nullopt;
    const std::string_view field(reinterpret_cast<const char*>(bytes.data() + at), size);
    const auto equals = field.find('=');
    if (equals == std::string_view::npos || equals == 0) return std::nullopt;
    result.fields_.push_back({field.substr(0, equals), bytes.subspan(at + equals + 1, size - equals - 1)});
    at += size;
  }
  return result;
}

std::optional<ByteView> RecordFields::find(std::string_view name, std::size_t size) const {
  for (const Field& field : fields_) {
    if (field.name == name && (size == 0 || field.value.size() == size)) return field.value;
  }
  return std::nullopt;
}

std::optional<BagOp> RecordFields::op() const {
  const auto value = find("op", 1);
  if (!value || value->front() < 2 || value->front() > 7) return std::nullopt;
  return static_cast<BagOp>(value->front());
}

std::optional<std::uint32_t> RecordFields::u32(std::string_view name) const {
  const auto value = find(name, 4);
  return value ? std::optional(readU32(value->data())) : std::nullopt;
}

std::optional<std::uint64_t> RecordFields::u64(std::string_view name) const {
  const auto value = find(name, 8);
  return value ? std::optional(readU64(value->data())) : std::nullopt;
}

std::optional<std::int64_t> RecordFields::timeNs(std::string_view name) const {
  const auto value = find(name, 8);
  if (!value) return std::nullopt;
  return static_cast<std::int64_t>(readU32(value->data())) * kSecondNs + readU32(value->data() + 4);
}

std::optional<std::string> RecordFields::text(std::string_view name) const {
  const auto value = find(name, 0);
  return value ? std::optional(std::string(value->begin(), value->end())) : std::nullopt;
}

std::optional<BagRecord> readRecord(ByteView bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < 8) return std::nullopt;
  const std::size_t header_size = readU32(bytes.data() + offset);
  const std::size_t header_at = offset + 4;
  if (header_size > bytes.size() - header_at || bytes.size() - header_at - header_size < 4)
    return std::nullopt;
  const std::size_t data_size = readU32(bytes.data() + header_at + header_size);
  const std::size_t data_at = header_at + header_size + 4;
  if (data_size > bytes.size() - data_at) return std::nullopt;
  auto fields = RecordFields::parse(bytes.subspan(header_at, header_size));
  if (!fields) return std::nullopt;
  return BagRecord{std::move(*fields), bytes.subspan(data_at, data_size), data_at + data_size};
}

RecordHeader::RecordHeader(BagOp op) {
  const std::uint8_t value = static_cast<std::uint8_t>(op);
  add("op", {&value, 1});
}

void RecordHeader::add(std::string_view name, ByteView value) {
  appendU32(bytes_, static_cast<std::uint32_t>(name.size() + 1 + value.size()));
  const ByteView key = view(name);
  bytes_.insert(bytes_.end(), key.begin(), key.end());
  bytes_.push_back('=');
  bytes_.insert(bytes_.end(), value.begin(), value.end());
}

RecordHeader& RecordHeader::u32(std::string_view name, std::uint32_t value) {
  Bytes bytes;
  appendU32(bytes, value);
  add(name, bytes);
  return *this;
}

RecordHeader& RecordHeader::u64(std::string_view name, std::uint64_t value) {
  Bytes bytes;
  appendU32(bytes, static_cast<std::uint32_t>(value));
  appendU32(bytes, static_cast<std::uint32_t>(value >> 32));
  add(name, bytes);
  return *this;
}

RecordHeader& RecordHeader::timeNs(std::string_view name, std::int64_t time_ns) {
  Bytes bytes;
  appendTime(bytes, time_ns);
  add(name, bytes);
  return *this;
}

RecordHeader& RecordHeader::text(std::string_view name, std::string_view value) {
  add(name, view(value));
  return *this;
}

void appendRecord(Bytes& out, const RecordHeader& header, ByteView data) {
  appendU32(out, static_cast<std::uint32_t>(header.bytes().size()));
  out.insert(out.end(), header.bytes().begin(), header.bytes().end());
  appendU32(out, static_cast<std::uint32_t>(data.size()));
  out.insert(out.end(), data.begin(), data.end());
}

}  // namespace vismem
