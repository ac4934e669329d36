/// @file Ice's protocol 1.0 and encoding 1.1 by hand, for messages that no Ice client sends.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace vismem::test {

/// Bytes in Ice's encoding: little-endian, sizes in one byte or five.
class WireBytes {
 public:
  WireBytes& byte(std::uint8_t value);
  template <typename T>
  WireBytes& number(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  /// As Ice writes it; of more than 254 in five bytes.
  WireBytes& size(std::int64_t value);
  WireBytes& text(std::string_view value);
  WireBytes& raw(std::string_view bytes);
  const std::string& bytes() const { return bytes_; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

enum class MessageType : std::uint8_t { kRequest = 0, kBatch = 1, kReply = 2, kValidate = 3, kClose = 4 };
constexpr std::size_t kHeaderSize = 14;

/// Magic, versions, type, no compression, and the size of header and body (or the one given, right or not).
std::string message(MessageType type, std::string_view body);
std::string message(MessageType type, std::string_view body, std::int32_t announced_size);

struct Call {
  std::int32_t id = 1;  ///< 0: oneway
  std::string name;
  std::string category;
  std::string facet;  ///< empty: none
  std::string operation;
  bool idempotent = true;
  std::string parameters;  ///< inside the encapsulation
};

std::string requestBody(const Call& call);
std::string request(const Call& call);

}  // namespace vismem::test
