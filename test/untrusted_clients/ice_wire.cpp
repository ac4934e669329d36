#include "untrusted_clients/ice_wire.h"

namespace vismem::test {
namespace {

constexpr int kEncapsulationHeader = 6;

}  // namespace

WireBytes& WireBytes::byte(std::uint8_t value) {
  bytes_ += static_cast<char>(value);
  return *this;
}

WireBytes& WireBytes::size(std::int64_t value) {
  if (value >= 0 && value < 255) return byte(static_cast<std::uint8_t>(value));
  return byte(255).number(static_cast<std::int32_t>(value));
}

WireBytes& WireBytes::text(std::string_view value) {
  return size(static_cast<std::int64_t>(value.size())).raw(value);
}

WireBytes& WireBytes::raw(std::string_view bytes) {
  bytes_ += bytes;
  return *this;
}

std::string message(MessageType type, std::string_view body) {
  return message(type, body, static_cast<std::int32_t>(kHeaderSize + body.size()));
}

std::string message(MessageType type, std::string_view body, std::int32_t announced_size) {
  WireBytes bytes;
  bytes.raw("IceP").byte(1).byte(0).byte(1).byte(0).byte(static_cast<std::uint8_t>(type)).byte(0);
  return bytes.number(announced_size).raw(body).take();
}

std::string requestBody(const Call& call) {
  WireBytes body;
  body.number(call.id).text(call.name).text(call.category);
  if (call.facet.empty()) {
    body.size(0);
  } else {
    body.size(1).text(call.facet);
  }
  body.text(call.operation).byte(call.idempotent ? 2 : 0).size(0);
  body.number(static_cast<std::int32_t>(kEncapsulationHeader + call.parameters.size())).byte(1).byte(1);
  return body.raw(call.parameters).take();
}

std::string request(const Call& call) {
  return message(MessageType::kRequest, requestBody(call));
}

}  // namespace vismem::test
