#include "untrusted_clients/garbage.h"

#include <array>

#include "untrusted_clients/ice_wire.h"

namespace vismem::test {
namespace {

constexpr std::int32_t kGigabyte = 1 << 30;

std::string noise(std::mt19937_64& random, std::size_t most) {
  std::string bytes(1 + random() % most, ' ');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

std::string webSocketRequest(const std::string& key, const std::string& more) {
  return "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: "
         "Upgrade\r\nSec-WebSocket-Protocol: "
         "ice.zeroc.com\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " +
         key + "\r\n" + more + "\r\n";
}

/// A header whose bytes from the version on are given.
std::string header(std::array<std::uint8_t, 6> versions_type_compression, std::int32_t size) {
  WireBytes bytes;
  bytes.raw("IceP");
  for (const auto byte : versions_type_compression) bytes.byte(byte);
  return bytes.number(size).take();
}

/// A request to ice_ping whose encapsulation says what it likes of its size and encoding.
std::string forgedEncapsulation(const std::string& identity, std::int32_t size, std::uint8_t major,
                                std::uint8_t minor) {
  WireBytes body;
  body.number(std::int32_t{1}).text(identity).text("").size(0).text("ice_ping").byte(0).size(0);
  body.number(size).byte(major).byte(minor);
  return message(MessageType::kRequest, body.bytes());
}

std::string compressed(std::mt19937_64& random, std::int32_t claimed_size) {
  WireBytes body;
  body.number(claimed_size).raw("BZh9").raw(noise(random, 200));
  std::string whole = message(MessageType::kRequest, body.bytes());
  whole[9] = 2;
  return whole;
}

}  // namespace

std::string garbage(std::mt19937_64& random, const std::string& identity) {
  return garbage(static_cast<int>(random() % kKindsOfGarbage), random, identity);
}

std::string garbage(int kind, std::mt19937_64& random, const std::string& identity) {
  const auto any = [&random](auto... values) {
    const std::array<std::int32_t, sizeof...(values)> all = {static_cast<std::int32_t>(values)...};
    return all[random() % all.size()];
  };
  const Call ping{1, identity, "", "", "ice_ping", false, ""};
  switch (kind) {
    case 0:
      return noise(random, 4096);
    case 1:
      return "GET /index.html HTTP/1.1\r\nHost: localhost\r\nUser-Agent: x\r\n\r\n";
    case 2:
      return "POST / HTTP/1.1\r\nContent-Length: 1073741824\r\n\r\n" + noise(random, 2000);
    case 3:
      return webSocketRequest("not base64 at all", "");
    case 4:
      return webSocketRequest("dGhlIHNhbXBsZSBub25jZQ==", "X: " + std::string(200'000, 'x') + "\r\n");
    case 5:  // a frame of a reserved kind, or one that announces 2^63 bytes
      return webSocketRequest("dGhlIHNhbXBsZSBub25jZQ==", "") +
             (any(0, 1) == 0 ? std::string("\x8f\xff", 2)
                             : std::string("\x82\xff\xff\xff\xff\xff\xff\xff\xff\xff", 10)) +
             noise(random, 300);
    case 6:  // frames that are not masked, or empty
      return webSocketRequest("dGhlIHNhbXBsZSBub25jZQ==", "") + std::string("\x82\x00\x82\x05IcePx", 9);
    case 7:
      return "GET / HTTP/1.1\r\nUpgrade: websocket\r\n\r\n";
    case 8:  // TLS
      return std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11) + noise(random, 512);
    case 9:
      return message(MessageType::kRequest, noise(random, 100), kGigabyte);
    case 10:
      return message(MessageType::kRequest, noise(random, 100),
                     any(-1, -14, -2147483647 - 1, 0, 1, 13, 2147483647));
    case 11:
      return message(MessageType::kRequest, "").substr(0, 1 + random() % (kHeaderSize - 1));
    case 12:
      return request(ping).substr(0, kHeaderSize + random() % 10);
    case 13: {
      const auto byte = [&random] { return static_cast<std::uint8_t>(random()); };
      return header({byte(), byte(), byte(), byte(), byte(), byte()}, static_cast<std::int32_t>(kHeaderSize));
    }
    case 14:
      return compressed(random, any(-1, 0, 14, 100, kGigabyte, 2147483647));
    case 15:
      return message(MessageType::kRequest, noise(random, 300));
    case 16:
      return message(MessageType::kReply, noise(random, 100));
    case 17: {
      WireBytes body;
      body.number(any(-1, 0, 2, 2147483647)).raw(requestBody(ping).substr(4));
      return message(MessageType::kBatch, body.bytes());
    }
    case 18:
      return message(MessageType::kValidate, noise(random, 50));
    case 19:
      return message(MessageType::kClose, noise(random, 50)) + request(ping);
    case 20:
      return forgedEncapsulation(identity, any(-1, 0, 5, 7, 1000, kGigabyte, 2147483647), 1, 1);
    case 21:
      return forgedEncapsulation(identity, 6, static_cast<std::uint8_t>(any(0, 1, 2, 255)),
                                 static_cast<std::uint8_t>(any(0, 2, 255)));
    case 22: {  // sizes inside the request that lie
      WireBytes body;
      body.number(std::int32_t{1})
          .byte(255)
          .number(any(-1, 100, kGigabyte, 2147483647))
          .raw(noise(random, 50));
      return message(MessageType::kRequest, body.bytes());
    }
    default: {  // a context of a thousand million entries
      WireBytes body;
      body.number(std::int32_t{1})
          .text(identity)
          .text("")
          .size(0)
          .text("ice_ping")
          .byte(0)
          .size(any(-1, kGigabyte, 3));
      return message(MessageType::kRequest, body.bytes());
    }
  }
}

}  // namespace vismem::test
