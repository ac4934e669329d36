// Tests A4, A5, A6.
#include "active_visual_memory/core/gaze/gaze_controller.h"

#include <gtest/gtest.h>

#include <cmath>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "active_visual_memory/published_attention.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

TEST(GazeStateMachine, FollowsTheTable) {
  using S = GazeState;
  const auto next = [](S state, auto set) {
    GazeConditions c;
    set(c);
    return nextGazeState(state, c);
  };
  EXPECT_EQ(next(S::kSelect, [](auto&) {}), S::kSelect);
  EXPECT_EQ(next(S::kSelect, [](auto& c) { c.has_target = true; }), S::kSaccade);
  EXPECT_EQ(next(S::kSaccade, [](auto&) {}), S::kSaccade);
  EXPECT_EQ(next(S::kSaccade, [](auto& c) { c.arrived = true; }), S::kAnalyse);
  EXPECT_EQ(next(S::kSaccade, [](auto& c) { c.timed_out = true; }), S::kSelect);
  EXPECT_EQ(next(S::kSaccade, [](auto& c) { c.target_gone = c.arrived = true; }), S::kSelect);
  EXPECT_EQ(next(S::kAnalyse, [](auto&) {}), S::kAnalyse);
  EXPECT_EQ(next(S::kAnalyse, [](auto& c) { c.relevant = true; }), S::kTrack);
  EXPECT_EQ(next(S::kAnalyse, [](auto& c) { c.analysed = true; }), S::kSelect);
  EXPECT_EQ(next(S::kTrack, [](auto&) {}), S::kTrack);
  EXPECT_EQ(next(S::kTrack, [](auto& c) { c.tracked = true; }), S::kSelect);
  EXPECT_EQ(next(S::kTrack, [](auto& c) { c.target_gone = true; }), S::kSelect);
}

TEST(ProportionalController, HasADeadZoneAGainAndALimitOnBothSides) {
  // Degrees, as in the chapter: dead zone 0.3, gain 2, at most 60.
  EXPECT_EQ(proportionalSpeed(0.29, 0.3, 2.0, 60.0), 0.0);
  EXPECT_DOUBLE_EQ(proportionalSpeed(0.3, 0.3, 2.0, 60.0), 0.6);
  EXPECT_DOUBLE_EQ(proportionalSpeed(-10.0, 0.3, 2.0, 60.0), -20.0);
  EXPECT_DOUBLE_EQ(proportionalSpeed(30.0, 0.3, 2.0, 60.0), 60.0) << "closed at the limit";
  EXPECT_DOUBLE_EQ(proportionalSpeed(-500.0, 0.3, 2.0, 60.0), -60.0);
}

/// A head that obeys, and a loop at 30 Hz around the controller.
struct Bench {
  AttentiveVisualMemoryParams params;
  AttentionPool pool;
  GazeController gaze;
  PanTilt head;
  Pose2 robot;
  PanTiltCommand last;
  StampUs now = 0;
  bool stuck = false;
  double most_pan = 0.0;
  double most_tilt = 0.0;

  explicit Bench(const AttentiveVisualMemoryParams& p)
      : params(p), pool(p.attention, p.rig), gaze(p.gaze, p.rig) {}

  GazeStatus status() const { return statusOf(gaze, now, pool); }

  void step(const std::vector<MemorySegment>& memory = {}) {
    const double dt = 1.0 / 30;
    now += 33'333;
    RobotObservation o;
    o.frame.stamp_us = now;
    o.T_odom_robot = robot;
    o.pan_tilt = head;
    pool.update(now, {memory, {}, {}}, robot, gaze.attended());
    if (const auto command = gaze.update(o, memory, pool)) {
      last = *command;
      if (command->kind == PanTiltCommand::Kind::kPosition) {
        most_pan = std::max(most_pan, std::abs(command->pan_rad));
        most_tilt = std::max(most_tilt, std::abs(command->tilt_rad));
      }
    }
    if (stuck) return;
    if (last.kind == PanTiltCommand::Kind::kPosition) {
      head.pan_rad += std::clamp(last.pan_rad - head.pan_rad, -2.5 * dt, 2.5 * dt);
      head.tilt_rad += std::clamp(last.tilt_rad - head.tilt_rad, -2.5 * dt, 2.5 * dt);
    } else {
      head.pan_rad += last.pan_rate_radps * dt;
      head.tilt_rad += last.tilt_rate_radps * dt;
    }
  }
};

class BothModes : public ::testing::TestWithParam<bool> {
 protected:
  AttentiveVisualMemoryParams params() const {
    return GetParam() ? AttentiveVisualMemoryParams::chapter() : AttentiveVisualMemoryParams::standard();
  }
};

TEST_P(BothModes, LooksAroundInsideTheLimitsWhenNothingIsKnown) {
  Bench bench(params());
  double low = 0.0;
  double high = 0.0;
  for (int i = 0; i < 30 * 120; ++i) {
    bench.step();
    low = std::min(low, bench.head.pan_rad);
    high = std::max(high, bench.head.pan_rad);
    ASSERT_LE(std::abs(bench.head.pan_rad), degToRad(159.0) + 0.02);
    ASSERT_LE(std::abs(bench.head.tilt_rad), degToRad(31.0) + 0.02);
  }
  EXPECT_LT(low, degToRad(-120.0));
  EXPECT_GT(high, degToRad(120.0));
  EXPECT_LE(bench.most_pan, degToRad(159.1));
  EXPECT_LE(bench.most_tilt, degToRad(31.1));
  EXPECT_GT(bench.status().visits, 30u);
}

TEST_P(BothModes, GivesUpWhatCannotBeReachedAndGoesOn) {
  Bench bench(params());
  bench.stuck = true;
  for (int i = 0; i < 30 * 20; ++i) bench.step();
  const auto status = bench.status();
  EXPECT_GE(status.given_up, 3u);
  bench.stuck = false;
  for (int i = 0; i < 30 * 20; ++i) bench.step();
  EXPECT_GT(bench.status().visits, status.visits);
}

TEST_P(BothModes, SettlesOnAFixationWithoutALimitCycle) {
  Bench bench(params());
  // 60 degrees to the left, 1.5 m away, on the floor.
  bench.gaze.fixate({1.5 * std::cos(degToRad(60.0)), 1.5 * std::sin(degToRad(60.0)), -0.3});
  for (int i = 0; i < 30 * 4; ++i) bench.step();
  const PanTilt settled = bench.head;
  EXPECT_NEAR(settled.pan_rad, degToRad(60.0), degToRad(0.6));
  double moved = 0.0;
  for (int i = 0; i < 30 * 4; ++i) {
    bench.step();
    moved = std::max(moved, std::abs(bench.head.pan_rad - settled.pan_rad));
  }
  EXPECT_LT(moved, degToRad(0.3));
  EXPECT_EQ(bench.status().state, GazeState::kTrack);
}

INSTANTIATE_TEST_SUITE_P(Gaze, BothModes, ::testing::Values(false, true),
                         [](const auto& p) { return p.param ? "chapter" : "standard"; });

TEST(GazeController, KeepsAFixationWhileTheRobotTurns) {
  Bench bench(AttentiveVisualMemoryParams::standard());
  bench.gaze.fixate({1.5, 0.0, -0.3});
  double worst = 0.0;
  for (int i = 0; i < 30 * 3; ++i) {
    bench.robot.theta = degToRad(30.0) * i / 30;  // 30 degrees per second
    bench.step();
    if (i > 15) worst = std::max(worst, std::abs(wrapAngle(bench.robot.theta + bench.head.pan_rad)));
  }
  EXPECT_LT(worst, degToRad(3.0));
}

TEST(GazeController, OffCommandsNothingAndHoldCommandsOnce) {
  Bench bench(AttentiveVisualMemoryParams::standard());
  bench.gaze.setMode(GazeMode::kOff);
  for (int i = 0; i < 30; ++i) bench.step();
  EXPECT_EQ(bench.most_pan, 0.0);
  EXPECT_FALSE(bench.gaze.imagesLost());
  bench.head = {0.4, -0.2};
  bench.gaze.setMode(GazeMode::kHold);
  bench.step();
  EXPECT_DOUBLE_EQ(bench.last.pan_rad, 0.4);
  EXPECT_FALSE(bench.gaze.imagesLost());
}

TEST(GazeController, CommandsNothingWithoutAPanTiltUnit) {
  const auto params = AttentiveVisualMemoryParams::standard();
  AttentionPool pool(params.attention, params.rig);
  GazeController gaze(params.gaze, params.rig);
  RobotObservation o;
  o.frame.stamp_us = 1;
  EXPECT_FALSE(gaze.update(o, {}, pool));
  EXPECT_FALSE(gaze.imagesLost());
}

TEST(GazeController, VisitsTenObjectsEvenly) {
  Bench bench(AttentiveVisualMemoryParams::standard());
  std::vector<MemorySegment> memory;
  for (int i = 0; i < 10; ++i) {
    MemorySegment s;
    s.id = i + 1;
    const double a = degToRad(-135.0 + 30.0 * i);
    s.odom = {{1.5 * std::cos(a), 1.5 * std::sin(a), -0.4}, {1.6 * std::cos(a), 1.6 * std::sin(a), -0.4}};
    memory.push_back(s);
  }
  std::vector<int> visits(10, 0);
  std::vector<double> before(10, 0.0);
  for (int i = 0; i < 30 * 120; ++i) {
    for (MemorySegment& s : memory) s.last_seen_us = bench.now + 33'333;
    bench.step(memory);
    for (int k = 0; k < 10; ++k) {
      const double salience = salienceOf(bench.pool, AttentionKind::kSegment, k + 1);
      if (salience < before[k] - 1.0) ++visits[k];
      before[k] = salience;
    }
  }
  const auto [least, most] = std::minmax_element(visits.begin(), visits.end());
  EXPECT_GE(*least, 4);
  EXPECT_LE(*most, 2 * *least);
}

/// Seconds from a client's request until the head looks there, in the middle of the visit of an object.
double waitOfAClient(double priority) {
  auto params = AttentiveVisualMemoryParams::standard();
  params.gaze.track_s = 3.0;
  Bench bench(params);
  MemorySegment object;
  object.id = 1;
  object.odom = {{1.5, 0.1, -0.4}, {1.6, 0.1, -0.4}};
  const auto see = [&] {
    object.last_seen_us = bench.now + 33'333;
    bench.step({object});
  };
  for (int i = 0; i < 3000; ++i) {
    see();
    const auto status = bench.status();
    if (status.state == GazeState::kTrack && status.target->kind == AttentionKind::kSegment) break;
  }
  EXPECT_EQ(bench.status().state, GazeState::kTrack);
  const StampUs asked_us = bench.now;
  bench.pool.request(
      {"client", "key", std::nullopt, PanTilt{degToRad(40), 0.0}, priority, bench.now + 60 * kSecondUs});
  for (int i = 0; i < 3000 && std::abs(bench.head.pan_rad - degToRad(40)) > degToRad(1); ++i) see();
  return toSeconds(bench.now - asked_us);
}

TEST(GazeController, AnUrgentRequestEndsTheVisitOfAnObject) {
  EXPECT_GT(waitOfAClient(kUrgentPriority - 1.0), 3.0);  // the rest of the visit, and the way
  EXPECT_LT(waitOfAClient(kUrgentPriority), 1.5);        // the way alone
}

/// A head that looks about by itself, and a client that asks for a direction.
struct GazeClientBench : Bench {
  GazeClientBench() : Bench(AttentiveVisualMemoryParams::standard()) {
    for (int i = 0; i < 10; ++i) step();
  }
  void ask(const char* key, double pan_rad, double priority = kUrgentPriority) {
    pool.request({"client", key, std::nullopt, PanTilt{pan_rad, -0.2}, priority, now + 60 * kSecondUs});
  }
  std::optional<double> preemptedTo() {
    const auto command = gaze.preempt(pool);
    return command ? std::optional<double>(command->pan_rad) : std::nullopt;
  }
};

TEST(GazeController, AnUrgentRequestPreemptsBeforeTheNextImage) {
  GazeClientBench bench;
  EXPECT_FALSE(bench.preemptedTo()) << "nobody asked";
  bench.ask("some day", 0.6, kUrgentPriority - 1.0);
  EXPECT_FALSE(bench.preemptedTo()) << "it is not urgent";
  bench.ask("now", 0.7);
  EXPECT_EQ(bench.preemptedTo(), 0.7);
  EXPECT_FALSE(bench.preemptedTo()) << "it was commanded already";
  bench.ask("now", -0.4);
  EXPECT_EQ(bench.preemptedTo(), -0.4) << "a request that jumps";
  bench.ask("now", -0.41);
  EXPECT_FALSE(bench.preemptedTo()) << "one that moves on is followed from image to image";
  bench.ask("another", 1.0);
  EXPECT_FALSE(bench.preemptedTo()) << "clients wait for each other";
}

TEST(GazeController, RequestsWaitWhileImagesAreLost) {
  GazeClientBench bench;
  ASSERT_TRUE(bench.gaze.imagesLost());
  bench.ask("now", 0.7);
  EXPECT_FALSE(bench.preemptedTo());
  bench.gaze.setMode(GazeMode::kHold);
  bench.gaze.setMode(GazeMode::kAttend);
  EXPECT_FALSE(bench.preemptedTo()) << "whatever mode they come to";
  bench.step();
  EXPECT_EQ(bench.last.pan_rad, 0.7) << "they are back";
}

TEST(GazeController, AnUrgentRequestIsFollowedByTheNextCommand) {
  GazeClientBench bench;
  bench.ask("now", 0.7);
  bench.step();
  EXPECT_EQ(bench.last.pan_rad, 0.7) << "not an image later";
}

}  // namespace
}  // namespace vismem
