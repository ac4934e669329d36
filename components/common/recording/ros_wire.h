/// @file ROS 1's serialization of numbers, texts and lists (little endian, lengths of 32 bits). Pure.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "common/recording/bag_format.h"

namespace vismem {

/// Reads one message from its beginning. Everything is checked against the message's end before it is
/// allocated. *Single-threaded.*
class RosReader {
 public:
  explicit RosReader(ByteView bytes) : bytes_(bytes) {}

  template <typename Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number> && std::endian::native == std::endian::little);
    Number value;
    std::memcpy(&value, take(sizeof(Number)).data(), sizeof(Number));
    return value;
  }
  std::int64_t timeNs() {
    const auto seconds = number<std::uint32_t>();
    return static_cast<std::int64_t>(seconds) * 1'000'000'000 + number<std::uint32_t>();
  }
  std::string text() {
    const ByteView bytes = take(number<std::uint32_t>());
    return {bytes.begin(), bytes.end()};
  }
  ByteView byteList() { return take(number<std::uint32_t>()); }
  /// Length of a list whose items take at least `item_size` bytes each.
  std::size_t listLength(std::size_t item_size) {
    const std::size_t length = number<std::uint32_t>();
    if (length > (bytes_.size() - at_) / item_size) overrun();
    return length;
  }

 private:
  [[noreturn]] void overrun() const {
    throw RecordingError("the message ends too early: " + std::to_string(bytes_.size()) + " bytes");
  }
  ByteView take(std::size_t count) {
    if (count > bytes_.size() - at_) overrun();
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  ByteView bytes_;
  std::size_t at_ = 0;
};

/// Appends one message to bytes.
class RosWriter {
 public:
  template <typename Number>
  RosWriter& number(Number value) {
    static_assert(std::is_arithmetic_v<Number> && std::endian::native == std::endian::little);
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof(Number));
    return *this;
  }
  RosWriter& u32(std::size_t value) { return number(static_cast<std::uint32_t>(value)); }
  RosWriter& stamp(std::int64_t stamp_us) {
    appendTime(bytes_, toTimeNs(stamp_us));
    return *this;
  }
  RosWriter& text(const std::string& value) {
    u32(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  RosWriter& byteList(ByteView value) {
    u32(value.size());
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    return *this;
  }
  void reserve(std::size_t size) { bytes_.reserve(size); }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

}  // namespace vismem
