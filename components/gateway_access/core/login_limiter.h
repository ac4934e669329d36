/// @file Holds wrong logins to a few a minute for each address. Pure: the time is passed in.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <string>

namespace vismem {

/// Counts wrong logins by address over the last minute. An address with as many as allowed is refused, also
/// with the right password, until its oldest one is a minute old. *Single-threaded.*
class LoginLimiter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds kWindow{60};
  /// Addresses in memory at most; beyond, the one whose last wrong login is the oldest is forgotten.
  static constexpr std::size_t kMostAddresses = 10'000;

  /// @param most wrong logins of an address in a minute, 1 or more.
  explicit LoginLimiter(int most) : most_(static_cast<std::size_t>(most)) {}

  /// @return how long the address must wait; zero if it may try now.
  std::chrono::milliseconds wait(const std::string& address, Time now);
  void wrong(const std::string& address, Time now);

 private:
  void forgetOld(Time now);

  const std::size_t most_;
  std::map<std::string, std::deque<Time>> wrong_;  ///< times of each, oldest first; never empty
};

/// What counts as one address: an IPv4 address, also one written in IPv6 (::ffff:10.0.0.5), or the network of
/// an IPv6 address (its first four groups), of which one machine may have every address.
std::string limitedAddress(const std::string& address);

}  // namespace vismem
