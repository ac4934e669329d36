// Tests A1, A3, A4, A5.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "active_visual_memory/published_attention.h"
#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

constexpr StampUs kImage_us = 33'333;
constexpr double kTick_s = 0.001;

/// Images at 30 Hz of a robot that moves as commanded, the gaze, and a unit of 150 degrees per second and
/// 1000 per second squared between the images.
class GazeBench {
 public:
  explicit GazeBench(const AttentiveVisualMemoryParams& p = AttentiveVisualMemoryParams::standard())
      : params(p), pool(p.attention, p.rig), gaze(p.gaze, p.rig) {}

  GazeStatus status() const { return statusOf(gaze, now_us, pool); }

  /// One image, then the time to the next. @param between called every millisecond.
  template <typename Between>
  void image(const std::vector<MemorySegment>& memory, Between between) {
    RobotObservation o;
    o.frame.stamp_us = now_us;
    o.T_odom_robot = robot;
    o.pan_tilt = unit.angles();
    pool.update(now_us, {memory, {}, {}}, robot, gaze.attended());
    if (const auto command = gaze.update(o, memory, pool)) {
      if (command->kind == PanTiltCommand::Kind::kPosition) {
        EXPECT_LE(std::abs(command->pan_rad), degToRad(159.0) + 1e-9);
        EXPECT_LE(std::abs(command->tilt_rad), degToRad(31.0) + 1e-9);
        EXPECT_LE(command->pan_rate_radps, params.gaze.pan.rate_radps + 1e-9);
        EXPECT_LE(command->tilt_rate_radps, params.gaze.tilt.rate_radps + 1e-9);
      }
      unit.command(*command);
    }
    const StampUs next_us = now_us + kImage_us;
    while (now_us < next_us) {
      unit.step(kTick_s);
      now_us += toStampUs(kTick_s);
      robot = robot * arcMotion(v_mps, w_radps, kTick_s);
      between();
    }
    now_us = next_us;
  }
  void image() {
    image({}, [] {});
  }
  /// The angle between the axis and a place.
  double errorTo(const Eigen::Vector3d& p_odom) const {
    const PanTilt aim = panTiltTowards(params.rig.mount, transform(inverse(robot), p_odom));
    return std::hypot(wrapAngle(aim.pan_rad - unit.angles().pan_rad), aim.tilt_rad - unit.angles().tilt_rad);
  }
  double now_s() const { return toSeconds(now_us); }

  AttentiveVisualMemoryParams params;
  AttentionPool pool;
  GazeController gaze;
  SimulatedPanTilt unit{PanTiltParams{}};
  Pose2 robot;
  double v_mps = 0.0;
  double w_radps = 0.0;
  StampUs now_us = kImage_us;
};

Eigen::Vector3d at(double angle_deg, double distance_m, double z_m) {
  const double a = degToRad(angle_deg);
  return {distance_m * std::cos(a), distance_m * std::sin(a), z_m};
}

TEST(GazeDynamics, ASaccadeOfSixtyDegreesSettlesWithinSixTenthsWithoutOvershoot) {
  for (const double angle : {60.0, -60.0, 45.0, 30.0, 10.0, -20.0}) {
    GazeBench bench;
    bench.gaze.fixate(at(0.0, 1.5, 0.2));
    for (int i = 0; i < 60; ++i) bench.image();
    ASSERT_LT(bench.errorTo(at(0.0, 1.5, 0.2)), degToRad(0.1));
    const Eigen::Vector3d target = at(angle, 1.5, 0.2);
    bench.gaze.fixate(target);
    const double begin_s = bench.now_s();
    double settled_s = 0.0;
    double overshoot = 0.0;
    for (int i = 0; i < 60; ++i) {
      bench.image({}, [&] {
        if (bench.errorTo(target) > degToRad(1.0)) settled_s = bench.now_s() - begin_s;
        const double beyond = (bench.unit.angles().pan_rad - degToRad(angle)) * (angle > 0 ? 1.0 : -1.0);
        overshoot = std::max(overshoot, beyond);
      });
    }
    std::printf("%+.0f degrees: settled within 1 degree after %.3f s, overshoot %.3f degrees\n", angle,
                settled_s, radToDeg(overshoot));
    EXPECT_LE(settled_s, 0.6) << angle;
    EXPECT_LE(radToDeg(overshoot), 1.0) << angle;
    EXPECT_LT(bench.errorTo(target), degToRad(0.2)) << angle;
  }
}

TEST(GazeDynamics, ThereIsNoLimitCycle) {
  for (const bool chapter : {false, true}) {
    GazeBench bench(chapter ? AttentiveVisualMemoryParams::chapter()
                            : AttentiveVisualMemoryParams::standard());
    const Eigen::Vector3d target = at(37.3, 1.7, 0.1);
    bench.gaze.fixate(target);
    for (int i = 0; i < 150; ++i) bench.image();
    const PanTilt settled = bench.unit.angles();
    double moved = 0.0;
    for (int i = 0; i < 300; ++i) {
      bench.image({}, [&] {
        moved = std::max({moved, std::abs(bench.unit.angles().pan_rad - settled.pan_rad),
                          std::abs(bench.unit.angles().tilt_rad - settled.tilt_rad)});
      });
    }
    EXPECT_LT(moved, degToRad(0.05)) << "chapter " << chapter;
  }
}

TEST(GazeDynamics, ATargetThatPassesByIsTrackedWithinTwoDegrees) {
  // 0.5 m/s, 2 m away, from 45 degrees on one side to 45 degrees on the other.
  GazeBench bench;
  const auto place = [&] { return Eigen::Vector3d(2.0, -2.0 + 0.5 * (bench.now_s() - 1.0), 0.2); };
  double sum = 0.0;
  double worst = 0.0;
  int count = 0;
  while (bench.now_s() < 9.0) {
    bench.gaze.fixate(bench.now_s() < 1.0 ? Eigen::Vector3d(2.0, -2.0, 0.2) : place());
    bench.image({}, [&] {
      if (bench.now_s() < 1.05) return;
      const double error = bench.errorTo(place());
      sum += error * error;
      worst = std::max(worst, error);
      ++count;
    });
  }
  const double rms = std::sqrt(sum / count);
  std::printf("target at 0.5 m/s: %.2f degrees RMS, at most %.2f\n", radToDeg(rms), radToDeg(worst));
  EXPECT_LT(radToDeg(rms), 2.0);
}

TEST(GazeDynamics, TheTurningRobotIsCompensatedWithinOneDegree) {
  GazeBench bench;
  const Eigen::Vector3d target = at(60.0, 1.5, 0.1);
  bench.gaze.fixate(target);
  for (int i = 0; i < 90; ++i) bench.image();
  bench.w_radps = degToRad(30.0);
  double sum = 0.0;
  double worst = 0.0;
  int count = 0;
  for (int i = 0; i < 30 * 6; ++i) {
    bench.image({}, [&] {
      const double error = bench.errorTo(target);
      sum += error * error;
      worst = std::max(worst, error);
      ++count;
    });
  }
  const double rms = std::sqrt(sum / count);
  std::printf("robot at 30 degrees per second: %.2f degrees RMS, at most %.2f\n", radToDeg(rms),
              radToDeg(worst));
  EXPECT_LT(radToDeg(rms), 1.0);
}

/// Things around the robot that the image shows whenever they are in its view.
std::vector<MemorySegment> thingsAround(int count, double from_deg, double step_deg) {
  std::vector<MemorySegment> things;
  for (int i = 0; i < count; ++i) {
    MemorySegment s;
    s.id = static_cast<std::uint64_t>(i) + 1;
    const Eigen::Vector3d p = at(from_deg + step_deg * i, 1.5, 0.0);
    s.odom = {p, p + Eigen::Vector3d(0.05, 0.05, 0.0)};
    things.push_back(s);
  }
  return things;
}

struct Visits {
  std::vector<std::vector<double>> times_s;
};

/// When each thing is visited: its salience falls to nothing.
Visits watch(GazeBench& bench, std::vector<MemorySegment> things, double seconds) {
  Visits visits{std::vector<std::vector<double>>(things.size())};
  std::vector<double> before(things.size(), 0.0);
  while (bench.now_s() < seconds) {
    for (MemorySegment& s : things) s.last_seen_us = bench.now_us;
    bench.image(things, [] {});
    for (std::size_t k = 0; k < things.size(); ++k) {
      const double salience = salienceOf(bench.pool, AttentionKind::kSegment, things[k].id);
      EXPECT_GE(salience, 0.0);
      if (salience < before[k]) {
        EXPECT_EQ(salience, 0.0) << "a visit leaves nothing (A1)";
        visits.times_s[k].push_back(bench.now_s());
      }
      before[k] = salience;
    }
  }
  return visits;
}

TEST(GazeFairness, TenThingsOfEqualRateAreVisitedAlike) {
  GazeBench bench;
  const Visits visits = watch(bench, thingsAround(10, -150.0, 33.0), 120.0);
  double longest = 0.0;
  double shortest_mean = 1e9;
  for (const auto& times : visits.times_s) {
    ASSERT_GE(times.size(), 5u);
    double sum = 0.0;
    for (std::size_t i = 1; i < times.size(); ++i) {
      longest = std::max(longest, times[i] - times[i - 1]);
      sum += times[i] - times[i - 1];
    }
    longest = std::max(longest, 120.0 - times.back());
    shortest_mean = std::min(shortest_mean, sum / static_cast<double>(times.size() - 1));
  }
  std::printf("ten things, 120 s: longest interval %.2f s, shortest mean %.2f s\n", longest, shortest_mean);
  EXPECT_LE(longest, 2.0 * shortest_mean);
}

TEST(GazeFairness, VisitsFollowTheRates) {
  // Ten places with rates 1 : 2 : 4, as clients ask for them.
  GazeBench bench;
  struct Request {
    double priority = 1.0;
    double pan_rad = 0.0;
    int visits = 0;
    double before = 0.0;
  };
  std::vector<Request> asked;
  double rates = 0.0;
  for (int i = 0; i < 10; ++i) {
    constexpr double kPriorities[] = {1.0, 4.0, 2.0};
    asked.push_back({kPriorities[i % 3], degToRad(-150.0 + 33.0 * i)});
    rates += asked.back().priority;
    GazeRequest request;
    request.client = "test";
    request.key = std::to_string(i);
    request.direction = PanTilt{asked.back().pan_rad, -0.3};
    request.priority = asked.back().priority;
    request.deadline_us = toStampUs(10'000.0);
    bench.pool.request(request);
  }
  constexpr double kSeconds = 600.0;
  while (bench.now_s() < kSeconds) {
    bench.image();
    for (const auto& point : pointsOf(bench.pool)) {
      if (point.kind != AttentionKind::kClient) continue;
      for (Request& request : asked) {
        if (std::abs(point.direction->pan_rad - request.pan_rad) > 1e-9) continue;
        if (point.salience < request.before) ++request.visits;
        request.before = point.salience;
      }
    }
  }
  int total = 0;
  for (const Request& request : asked) total += request.visits;
  std::printf("rates 1 : 2 : 4, %.0f s:", kSeconds);
  for (const Request& request : asked) {
    const double fair = total * request.priority / rates;
    std::printf(" %d (%.1f)", request.visits, fair);
    EXPECT_NEAR(request.visits, fair, 0.25 * fair) << "rate " << request.priority;
  }
  std::printf("\n");
}

TEST(GazeScanning, CoversTheWholeRangeOfTheUnitInAStatedTime) {
  AttentiveVisualMemoryParams params = AttentiveVisualMemoryParams::standard();
  params.attention.scan_min_tilt_rad = params.rig.min_tilt_rad;
  params.attention.scan_max_tilt_rad = params.rig.max_tilt_rad;
  GazeBench bench(params);
  // Every direction the unit can take was inside a quiet image of 60 x 46 degrees.
  constexpr int kStep_deg = 3;
  std::vector<PanTilt> unseen;
  for (int pan = -159; pan <= 159; pan += kStep_deg) {
    for (int tilt = -31; tilt <= 31; tilt += kStep_deg) unseen.push_back({degToRad(pan), degToRad(tilt)});
  }
  double occluded_s = 0.0;
  while (!unseen.empty() && bench.now_s() < 60.0) {
    bench.image();
    if (bench.status().state != GazeState::kAnalyse) continue;
    const PanTilt axis = bench.unit.angles();
    std::erase_if(unseen, [&](const PanTilt& d) {
      return std::abs(d.pan_rad - axis.pan_rad) <= degToRad(28.0) &&
             std::abs(d.tilt_rad - axis.tilt_rad) <= degToRad(21.0);
    });
    occluded_s = bench.now_s();
  }
  std::printf("systematic scanning of 318 x 62 degrees: %.1f s\n", occluded_s);
  EXPECT_TRUE(unseen.empty()) << unseen.size() << " directions were never looked at";
  EXPECT_LE(occluded_s, 25.0);
}

TEST(GazeScanning, TheFloorAroundIsLookedAtOnceAtTheBeginning) {
  GazeBench bench;
  double low = 0.0;
  double high = 0.0;
  while (bench.now_s() < 8.0) {
    bench.image();
    low = std::min(low, bench.unit.angles().pan_rad);
    high = std::max(high, bench.unit.angles().pan_rad);
  }
  EXPECT_LT(low, degToRad(-155.0));
  EXPECT_GT(high, degToRad(155.0));
}

TEST(GazeDynamics, TheSameSeedGivesTheSameMotion) {
  const auto run = [](std::uint64_t seed) {
    auto params = AttentiveVisualMemoryParams::standard();
    params.attention.scanning = AttentionPool::Scanning::kRandom;
    params.attention.look_around_first = false;
    params.attention.seed = seed;
    GazeBench bench(params);
    std::vector<double> pans;
    for (int i = 0; i < 600; ++i) {
      bench.image();
      pans.push_back(bench.unit.angles().pan_rad);
    }
    return pans;
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5), run(6));
}

}  // namespace
}  // namespace vismem
