#include "gateway_access/core/login_limiter.h"

#include <gtest/gtest.h>

namespace vismem {
namespace {

using namespace std::chrono_literals;

TEST(LoginLimiter, RefusesAnAddressAfterFiveWrongLoginsUntilTheFirstIsAMinuteOld) {
  LoginLimiter limiter(5);
  LoginLimiter::Time now{};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(limiter.wait("10.0.0.5", now), 0ms) << i;
    limiter.wrong("10.0.0.5", now);
    now += 2s;
  }
  EXPECT_EQ(limiter.wait("10.0.0.5", now), 50s);
  EXPECT_EQ(limiter.wait("10.0.0.6", now), 0ms) << "another address";
  EXPECT_EQ(limiter.wait("10.0.0.5", now + 50s - 1ms), 1ms);
  EXPECT_EQ(limiter.wait("10.0.0.5", now + 50s), 0ms);
  limiter.wrong("10.0.0.5", now + 50s);
  EXPECT_EQ(limiter.wait("10.0.0.5", now + 50s), 2s) << "the second one is still young";
}

TEST(LoginLimiter, HoldsAGuesserToFiveAMinute) {
  LoginLimiter limiter(5);
  int tries = 0;
  for (LoginLimiter::Time now{}; now < LoginLimiter::Time{} + 10min; now += 5ms) {
    if (limiter.wait("10.0.0.5", now) > 0ms) continue;
    limiter.wrong("10.0.0.5", now);
    ++tries;
  }
  EXPECT_EQ(tries, 50);
}

TEST(LoginLimiter, ForgetsTheOldestOfVeryManyAddresses) {
  LoginLimiter limiter(1);
  LoginLimiter::Time now{};
  for (std::size_t i = 0; i <= LoginLimiter::kMostAddresses; ++i) {
    limiter.wrong(std::to_string(i), now);
    now += 1ms;
  }
  EXPECT_EQ(limiter.wait("0", now), 0ms);
  EXPECT_GT(limiter.wait("1", now), 0ms);
  EXPECT_GT(limiter.wait(std::to_string(LoginLimiter::kMostAddresses), now), 0ms);
}

TEST(LimitedAddress, IsTheNetworkOfAnIpv6Address) {
  EXPECT_EQ(limitedAddress("10.0.0.5"), "10.0.0.5");
  EXPECT_EQ(limitedAddress("::ffff:10.0.0.5"), "10.0.0.5");
  EXPECT_EQ(limitedAddress("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
  EXPECT_EQ(limitedAddress("2001:db8:1:2::9"), limitedAddress("2001:db8:1:2:ffff::1"));
  EXPECT_EQ(limitedAddress("local"), "local");
}

}  // namespace
}  // namespace vismem
