#include "application/app/silence.h"

#include <gmock/gmock.h>

namespace vismem {
namespace {

using namespace std::chrono_literals;

TEST(Silence, IsTooLongAfterFifteenSecondsWithoutAPause) {
  Silence silence;
  const Silence::TimePoint start{100s};
  EXPECT_FALSE(silence.isTooLong(start + 15s, start, false));
  EXPECT_TRUE(silence.isTooLong(start + 15s + 1ms, start, false));
  EXPECT_FALSE(silence.isTooLong(start + 15s + 1ms, start + 1s, false)) << "the time advanced meanwhile";
}

TEST(Silence, BeginsAfterAPauseOfAnyLength) {
  Silence silence;
  const Silence::TimePoint start{100s};
  for (int s = 0; s <= 3600; ++s) ASSERT_FALSE(silence.isTooLong(start + s * 1s, start, true)) << s;
  EXPECT_FALSE(silence.isTooLong(start + 3615s, start, false));
  EXPECT_TRUE(silence.isTooLong(start + 3615s + 1ms, start, false)) << "resumed, and nothing came";
}

}  // namespace
}  // namespace vismem
