// Limits of commands, with their exact messages.
#include "common/robot/command_limits.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

using Kind = PanTiltCommand::Kind;
using Answer = PortReply::Kind;

const PanTiltLimits kLimits{degToRad(-159), degToRad(159), degToRad(-31),
                            degToRad(31),   degToRad(150), degToRad(90)};

TEST(LimitCommand, KeepsWhatIsWithinTheLimits) {
  const auto limited = limitCommand(kLimits, {Kind::kPosition, 1.0, -0.5, 0.3, 0.0});
  EXPECT_EQ(limited.reply.kind, Answer::kAccepted);
  EXPECT_EQ(limited.command.pan_rad, 1.0);
  EXPECT_EQ(limited.command.tilt_rad, -0.5);
  EXPECT_EQ(limited.command.pan_rate_radps, 0.3);
  EXPECT_EQ(limited.command.tilt_rate_radps, degToRad(90)) << "0 is the maximum";
}

TEST(LimitCommand, SaysWhatItChangedToWhat) {
  const auto far = limitCommand(kLimits, {Kind::kPosition, degToRad(200), degToRad(-40), 1e6, 0.0});
  EXPECT_EQ(far.reply.kind, Answer::kAdjusted);
  EXPECT_EQ(far.reply.message, "pan 200 deg to 159, tilt -40 deg to -31 (the limit)");
  EXPECT_EQ(far.command.pan_rad, degToRad(159));
  EXPECT_EQ(far.command.pan_rate_radps, degToRad(150)) << "no adjustment, only a bound that does not bind";
  const auto fast = limitCommand(kLimits, {Kind::kVelocity, 0.0, 0.0, degToRad(-300), 0.1});
  EXPECT_EQ(fast.reply.message, "pan rate -300 deg/s to -150 (the limit)");
  EXPECT_EQ(fast.command.pan_rate_radps, degToRad(-150));
}

TEST(LimitCommand, RefusesWhatMakesNoSense) {
  const auto absurd = limitCommand(kLimits, {Kind::kPosition, std::nan(""), HUGE_VAL, -1.0, 0.0});
  EXPECT_EQ(absurd.reply.kind, Answer::kRejected);
  EXPECT_EQ(absurd.reply.message,
            "pan = nan (must be finite), tilt = inf (must be finite), "
            "bound of the pan rate = -1 (must be finite and >= 0)");
}

TEST(LimitVelocity, ClampsBothSpeedsAndRefusesNonsense) {
  const BaseLimits limits{0.5, degToRad(100), 0.3};
  EXPECT_EQ(limitVelocity(limits, 0.5, -1.0).reply.kind, Answer::kAccepted);
  const auto fast = limitVelocity(limits, -2.0, 5.0);
  EXPECT_EQ(fast.reply.message, "speed -2 m/s to -0.5, turn rate 286.5 deg/s to 100 (the limit)");
  EXPECT_EQ(fast.v_mps, -0.5);
  EXPECT_EQ(fast.w_radps, degToRad(100));
  EXPECT_EQ(limitVelocity(limits, 0.1, std::nan("")).reply.message, "turn rate = nan (must be finite)");
}

}  // namespace
}  // namespace vismem
