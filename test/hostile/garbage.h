/// @file What comes over a connection from those who do not speak Ice, or speak it falsely.
#pragma once

#include <random>
#include <string>

namespace vismem::test {

/// One delivery of bytes, drawn from a seed: noise, HTTP, broken WebSocket handshakes and frames, TLS,
/// headers with oversized, negative and too small sizes, wrong versions and compression, cut messages, forged
/// encapsulations, batches and replies nobody asked for.
/// @param identity  an object of the server, so that what is forged reaches it.
std::string garbage(std::mt19937_64& random, const std::string& identity);
constexpr int kKindsOfGarbage = 24;
/// One of those kinds.
std::string garbage(int kind, std::mt19937_64& random, const std::string& identity);

}  // namespace vismem::test
