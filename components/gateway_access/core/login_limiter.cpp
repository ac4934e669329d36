#include "gateway_access/core/login_limiter.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

namespace vismem {

std::chrono::milliseconds LoginLimiter::wait(const std::string& address, Time now) {
  const auto found = wrong_.find(address);
  if (found == wrong_.end()) return {};
  auto& times = found->second;
  while (!times.empty() && now - times.front() >= kWindow) times.pop_front();
  if (times.empty()) {
    wrong_.erase(found);
    return {};
  }
  if (times.size() < most_) return {};
  return std::chrono::ceil<std::chrono::milliseconds>(times.front() + kWindow - now);
}

void LoginLimiter::wrong(const std::string& address, Time now) {
  if (wrong_.size() >= kMostAddresses && !wrong_.contains(address)) forgetOld(now);
  auto& times = wrong_[address];
  times.push_back(now);
  if (times.size() > most_) times.pop_front();
}

void LoginLimiter::forgetOld(Time now) {
  std::erase_if(wrong_, [&](const auto& entry) { return now - entry.second.back() >= kWindow; });
  if (wrong_.size() < kMostAddresses) return;
  wrong_.erase(std::min_element(wrong_.begin(), wrong_.end(), [](const auto& a, const auto& b) {
    return a.second.back() < b.second.back();
  }));
}

std::string limitedAddress(const std::string& address) {
  in6_addr bytes{};
  if (inet_pton(AF_INET6, address.c_str(), &bytes) != 1) return address;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (IN6_IS_ADDR_V4MAPPED(&bytes)) return inet_ntop(AF_INET, &bytes.s6_addr[12], text.data(), text.size());
  std::fill(std::begin(bytes.s6_addr) + 8, std::end(bytes.s6_addr), 0);
  return std::string(inet_ntop(AF_INET6, &bytes, text.data(), text.size())) + "/64";
}

}  // namespace vismem
