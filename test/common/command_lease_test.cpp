// One client commands an actuator at a time: a state machine with the time passed in.
#include "common/robot/command_lease.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

class CommandLeaseTest : public testing::Test {
 protected:
  std::string take(const std::string& client, int priority, CommandLease::Duration timeout = 2s,
                   const std::string& connection = "a") {
    return lease.acquire(client, priority, timeout, connection, now).id;
  }
  std::string command(const std::string& id, const std::string& connection = "a") {
    return lease.admit(id, connection, now);
  }

  int ids = 0;
  CommandLease lease{[this] { return "id" + std::to_string(++ids); }};
  CommandLease::Time now{1000s};
};

TEST_F(CommandLeaseTest, TheHolderCommandsAndNobodyElse) {
  const std::string gui = take("gui", 10);
  ASSERT_EQ(gui, "id1");
  EXPECT_THAT(command(gui), IsEmpty());
  EXPECT_EQ(command("", "b"), "gui holds the lease (priority 10)");
  EXPECT_EQ(command("id2", "b"), "gui holds the lease (priority 10)");
  const auto state = lease.state(now);
  EXPECT_TRUE(state.held);
  EXPECT_EQ(state.client, "gui");
  EXPECT_EQ(state.priority, 10);
  EXPECT_FALSE(state.implicit);
  EXPECT_DOUBLE_EQ(state.remaining_s, 2.0);
}

TEST_F(CommandLeaseTest, AnExpiredLeaseFrees) {
  const std::string gui = take("gui", 10, 2s);
  now += 2s - 1ms;
  EXPECT_THAT(take("other", 10), IsEmpty());
  now += 1ms;
  EXPECT_FALSE(lease.state(now).held);
  EXPECT_EQ(command(gui), "the lease has ended");
  EXPECT_THAT(take("other", 0), "id2");
}

TEST_F(CommandLeaseTest, CommandsAndRenewalsProlongIt) {
  const std::string gui = take("gui", 10, 2s);
  for (int i = 0; i < 5; ++i) {
    now += 1500ms;
    EXPECT_THAT(command(gui), IsEmpty());
    now += 1500ms;
    EXPECT_THAT(lease.renew(gui, now), IsEmpty());
  }
  now += 2s;
  EXPECT_EQ(lease.renew(gui, now), "the lease has ended");
}

TEST_F(CommandLeaseTest, OnlyAHigherPriorityTakesOver) {
  const std::string low = take("low", 10);
  EXPECT_THAT(lease.acquire("equal", 10, 2s, "a", now).reason, HasSubstr("low holds the lease (priority 10"));
  const std::string high = take("high", 11);
  ASSERT_FALSE(high.empty());
  EXPECT_THAT(command(low), HasSubstr("high holds the lease"));
  EXPECT_THAT(lease.renew(low, now), HasSubstr("high holds the lease"));
  EXPECT_FALSE(lease.release(low, now)) << "what ended is not given back, and the new holder keeps its lease";
  EXPECT_THAT(command(high), IsEmpty());
}

TEST_F(CommandLeaseTest, ReleaseFreesAtOnce) {
  const std::string gui = take("gui", 10);
  EXPECT_TRUE(lease.release(gui, now));
  EXPECT_FALSE(lease.release(gui, now));
  EXPECT_FALSE(lease.state(now).held);
  EXPECT_THAT(take("other", 0), "id2");
}

TEST_F(CommandLeaseTest, EndsWithTheConnectionThatItWasAcquiredOver) {
  const std::string gui = take("gui", 10, 60s, "10.0.0.5:41");
  EXPECT_FALSE(lease.releaseConnection("10.0.0.5:42", now)) << "another one's";
  EXPECT_FALSE(lease.releaseConnection("", now));
  EXPECT_THAT(command(gui), IsEmpty());
  EXPECT_TRUE(lease.releaseConnection("10.0.0.5:41", now));
  EXPECT_EQ(command(gui), "the lease has ended");
  EXPECT_THAT(command("", "10.0.0.5:42"), IsEmpty());
  EXPECT_TRUE(lease.releaseConnection("10.0.0.5:42", now)) << "an implicit one, too";
  lease.stop(now);
  EXPECT_FALSE(lease.releaseConnection("", now)) << "nobody's connection ends a stop";
}

TEST_F(CommandLeaseTest, ACommandWithoutALeaseTakesAnImplicitOneForItsConnection) {
  EXPECT_THAT(command("", "a"), IsEmpty());
  EXPECT_TRUE(lease.state(now).implicit);
  EXPECT_EQ(lease.state(now).client, "a");
  EXPECT_EQ(command("", "b"), "a holds the lease (priority 0)");
  now += 900ms;
  EXPECT_THAT(command("", "a"), IsEmpty()) << "each command renews it";
  now += 900ms;
  EXPECT_FALSE(command("", "b").empty());
  now += 100ms;
  EXPECT_THAT(command("", "b"), IsEmpty());
}

TEST_F(CommandLeaseTest, AnImplicitLeaseLastsAsLongAsTheCommand) {
  EXPECT_THAT(lease.admit("", "a", now, 250ms), IsEmpty());
  now += 249ms;
  EXPECT_EQ(lease.admit("", "b", now, 250ms), "a holds the lease (priority 0)");
  now += 1ms;
  EXPECT_THAT(lease.admit("", "b", now, 250ms), IsEmpty()) << "the first client's command has ended, too";
}

TEST_F(CommandLeaseTest, AnImplicitLeaseYieldsToEveryPriorityAboveZero) {
  EXPECT_THAT(command("", "a"), IsEmpty());
  EXPECT_THAT(take("polite", 0), IsEmpty());
  const std::string gui = take("gui", 1);
  ASSERT_FALSE(gui.empty());
  EXPECT_FALSE(command("", "a").empty());
  EXPECT_THAT(command(gui), IsEmpty());
}

TEST_F(CommandLeaseTest, NobodyPassesForTheHolderOfAnImplicitLease) {
  EXPECT_THAT(command("", "a"), IsEmpty());
  EXPECT_FALSE(lease.release("", now));
  EXPECT_FALSE(lease.renew("", now).empty());
  EXPECT_TRUE(lease.state(now).held);
}

TEST_F(CommandLeaseTest, StopEndsEveryLeaseAndHoldsOffEverybody) {
  const std::string gui = take("gui", 100);
  lease.stop(now);
  EXPECT_EQ(command(gui), "stopped: no command for another 1.0 s");
  EXPECT_THAT(command("", "a"), HasSubstr("stopped"));
  EXPECT_THAT(lease.acquire("gui", 100, 2s, "a", now).reason, HasSubstr("stopped"));
  EXPECT_EQ(lease.state(now).client, "stop");
  now += 1s;
  EXPECT_EQ(command(gui), "the lease has ended") << "the old lease does not come back";
  EXPECT_THAT(command("", "a"), IsEmpty());
}

// Whatever happens, at most one of several clients has its commands followed until the lease changes hands.
TEST_F(CommandLeaseTest, AtMostOneClientIsFollowedAtAnyMoment) {
  std::mt19937 random(7);
  std::array<std::string, 4> held;
  for (int step = 0; step < 20'000; ++step) {
    now += std::chrono::milliseconds(random() % 400);
    const std::size_t who = random() % held.size();
    const std::string name = std::to_string(who);
    switch (random() % 5) {
      case 0:
        if (auto id = take(name, static_cast<int>(random() % 5)); !id.empty()) held[who] = id;
        break;
      case 1:
        lease.release(held[who], now);
        break;
      case 2:
        if (random() % 20 == 0) lease.stop(now);
        break;
      default:
        break;
    }
    CommandLease copy = lease;
    int followed = 0;
    const auto state = copy.state(now);
    for (std::size_t i = 0; i < held.size(); ++i) {
      CommandLease one_of_many = lease;
      const bool by_lease = !held[i].empty() && one_of_many.admit(held[i], std::to_string(i), now).empty();
      CommandLease without = lease;
      const bool by_connection = without.admit("", std::to_string(i), now).empty();
      if (state.held) followed += by_lease || by_connection;
      EXPECT_FALSE(by_lease && state.client != std::to_string(i)) << "step " << step;
    }
    EXPECT_LE(followed, 1) << "step " << step;
    if (random() % 3 == 0) command(held[who], name);
  }
}

}  // namespace
}  // namespace vismem
