/// @file Bytes of connections that do not follow Ice's protocol.
#pragma once

#include <random>
#include <string>

namespace vismem::test {

/// One delivery of bytes, drawn from a seed: noise, HTTP, broken WebSocket handshakes and frames, TLS,
/// headers with oversized, negative and too small sizes, wrong versions and compression, cut messages, forged
/// encapsulations, unsolicited batches and replies.
/// @param identity an object of the server, as the target of forged messages.
std::string garbage(std::mt19937_64& random, const std::string& identity);
constexpr int kKindsOfGarbage = 24;
/// One of those kinds.
std::string garbage(int kind, std::mt19937_64& random, const std::string& identity);

}  // namespace vismem::test
