// Tests L12, B2: each part of the default mode can be switched off alone, and each has its effect.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/geometry/angles.h"
#include "localization/core/likelihood/robust_likelihood.h"
#include "localization/core/localizer.h"
#include "localization/corridor_world.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

LocalizerParams defaultsBut(const std::function<void(LocalizerParams&)>& change) {
  LocalizerParams params = localizerPreset(LocalizationMode::kDefault);
  change(params);
  return params;
}

double errorOf(const PoseEstimate& estimate, const Pose2& truth) {
  return estimate.T_world_robot ? (estimate.T_world_robot->position() - truth.position()).norm() : 10.0;
}

// Unbounded squared distances give false segments full influence.
TEST(Ablation, WithoutTheBoundFalseSegmentsBiasThePose) {
  SegmentMap corner;
  corner.segments = {{{{0, 0, 0}, {3, 0, 0}}, "skirting", 0.0}, {{{0, 0, 0}, {0, 3, 0}}, "skirting", 0.0}};
  const Pose2 truth{1.0, 1.2, 0.4};
  MemorySnapshot snapshot;
  test::remember(snapshot, corner, truth, 2.0);
  // False ones, along the walls' directions and half a metre off.
  SegmentMap wrong;
  wrong.segments = {{{{0.4, 0.5, 0}, {2.0, 0.5, 0}}, "skirting", 0.0},
                    {{{0.45, 0.4, 0}, {0.45, 2.0, 0}}, "skirting", 0.0}};
  test::remember(snapshot, wrong, truth, 2.0);
  for (const bool bounded : {true, false}) {
    const LocalizerParams params =
        defaultsBut([&](LocalizerParams& p) { p.robust.likelihood.bounded = bounded; });
    const MapIndex map(corner, robustIndex(params.robust.likelihood, params.map));
    const RobustLikelihood likelihood(map, params.robust.likelihood);
    const auto refined = likelihood.refine(observeMemory(snapshot, map, params.robust.observation), {truth},
                                           Matrix5d::Zero(), 1.0, 10, 0.0);
    const double error = (refined.placement.T_world_robot.position() - truth.position()).norm();
    if (bounded) {
      EXPECT_LT(error, 0.02);
    } else {
      EXPECT_GT(error, 0.15);
    }
  }
}

TEST(Ablation, RefinementMovesARaceToThePose) {
  const SegmentMap map = test::corridorMap();
  const Pose2 truth{6.9, 0.05, 0.05};
  Localizer localizer(
      defaultsBut([](LocalizerParams& p) { p.explorers.count_lost = p.explorers.count_reliable = 0; }), map,
      1);
  auto updateAt = [&](int i) { return test::viewFrom(map, truth, i * 200'000, 0.0, degToRad(-15), 3.0); };
  localizer.update(updateAt(1));
  localizer.setPose({6.95, 0.1, 0.03});
  for (int i = 2; i < 12; ++i) localizer.update(updateAt(i));
  EXPECT_LT(errorOf(localizer.latest(), truth), 0.03);
}

// With the motion prior, one view of one wall keeps the information of earlier images.
TEST(Ablation, TheFilterKeepsTheInformationOfEarlierImages) {
  const SegmentMap map = test::corridorMap();
  const Pose2 truth{2.4, 0.0, 0.0};
  Localizer localizer(
      defaultsBut([](LocalizerParams& p) { p.explorers.count_lost = p.explorers.count_reliable = 0; }), map,
      1);
  localizer.update(test::viewFrom(map, truth, 100'000, 0.0, degToRad(-15), 3.0));
  localizer.setPose(truth);
  for (int i = 2; i < 8; ++i) {
    localizer.update(test::viewFrom(map, truth, i * 200'000, 0.0, degToRad(-15), 3.0));
  }
  const double along_before = std::sqrt(localizer.latest().P(0, 0));
  // A view of the plain wall to the right has no information along the corridor.
  SegmentMap bare;
  bare.segments = {{{{1.6, -0.75, 0}, {3.2, -0.75, 0}}, "skirting", 0.0}};
  localizer.update(test::viewFrom(bare, truth, 8 * 200'000, degToRad(-90), degToRad(-25), 0.8));
  EXPECT_LT(std::sqrt(localizer.latest().P(0, 0)), along_before + 0.05);
}

// The memory moves with odometry and has no information about odometry's error.
TEST(Ablation, TheReportedCovarianceGrowsWithOdometryWhereTheImageIsEmpty) {
  const SegmentMap map = test::corridorMap();
  const LocalizerParams params = defaultsBut([](LocalizerParams& p) {
    p.explorers.count_lost = p.explorers.count_reliable = 0;
    p.robust.filter.odometry_bias.setZero();
  });
  Localizer localizer(params, map, 1);
  constexpr double kStep_m = 0.06;
  constexpr int kSeen = 15;
  const auto step = [&](int i) {
    const Pose2 truth{1.0 + kStep_m * i, 0.0, 0.0};
    MemoryUpdate update = test::viewFrom(map, truth, i * 200'000, 0.0, degToRad(-15), 3.0);
    auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
    test::remember(*snapshot, map, truth, 3.0);
    for (MemorySegment& segment : snapshot->segments) {
      segment.last_seen_us = std::min<StampUs>(segment.last_seen_us, kSeen * 200'000);
    }
    auto view = std::make_shared<ImageAnalysis>(*update.analysis);
    if (i > kSeen) view->observed.clear();
    localizer.update({snapshot, view});
    if (i == 1) localizer.setPose(truth);
  };
  // A segment seen within half a second counts as current.
  constexpr int kOld = kSeen + 3;
  for (int i = 1; i <= kOld; ++i) step(i);
  const Eigen::Matrix3d seen = localizer.latest().P;
  EXPECT_LT(std::sqrt(seen(2, 2)), degToRad(1.0));
  constexpr int kBlind = 30;
  for (int i = kOld + 1; i <= kOld + kBlind; ++i) step(i);
  const Eigen::Matrix3d blind = localizer.latest().P;
  const double turn = params.robust.filter.odometry.turn_per_m * kStep_m;
  const double along = params.robust.filter.odometry.share * kStep_m;
  EXPECT_GT(blind(2, 2), seen(2, 2) + 0.99 * kBlind * turn * turn);
  EXPECT_GT(blind(0, 0), seen(0, 0) + 0.99 * kBlind * along * along);
}

// One odd image does not replace a long-lived winner; without evidence it does.
TEST(Ablation, EvidenceSurvivesOneOddImage) {
  const SegmentMap map = test::corridorMap();
  const Pose2 truth{6.9, 0.0, 0.0};
  const Pose2 elsewhere{-0.1, 4.0, degToRad(-90)};
  for (const bool remembers : {true, false}) {
    Localizer localizer(defaultsBut([&](LocalizerParams& p) {
                          if (!remembers)
                            p.robust.history.forgetting = p.robust.evidence.lead =
                                p.robust.history.jump_log_prior = 0.0;
                        }),
                        map, 1);
    localizer.update(test::viewFrom(map, truth, 200'000, 0.0, degToRad(-15), 3.0));
    localizer.setPose(truth);
    int i = 2;
    for (; i < 40; ++i) localizer.update(test::viewFrom(map, truth, i * 200'000, 0.0, degToRad(-15), 3.0));
    ASSERT_LT(errorOf(localizer.latest(), truth), 0.2);
    // The view of another place, while odometry reports a standing robot.
    bool left = false;
    for (int k = 0; k < 1; ++k, ++i) {
      MemoryUpdate odd = test::viewFrom(map, elsewhere, i * 200'000, 0.0, degToRad(-15), 3.0);
      auto snapshot = std::make_shared<MemorySnapshot>(*odd.snapshot);
      snapshot->T_odom_robot = truth;
      left = errorOf(localizer.update({snapshot, odd.analysis}), truth) > 1.0 || left;
    }
    EXPECT_EQ(left, !remembers);
  }
}

// A memory of the old place does not hold a displaced robot there.
TEST(Ablation, AMemoryOfTheOldPlaceDoesNotDelayTheNewOne) {
  const SegmentMap map = test::corridorMap();
  const Pose2 before{6.9, 0.0, 0.0};
  const Pose2 after{-0.1, 2.0, degToRad(90)};
  const auto iterations = [&](ObservationSource source, std::uint64_t seed) {
    Localizer localizer(defaultsBut([&](LocalizerParams& p) { p.robust.observation.source = source; }), map,
                        seed);
    const auto look = [&](const Pose2& at, int i) {
      MemoryUpdate update = test::viewFrom(map, at, i * 200'000, 0.0, degToRad(-15), 3.0);
      auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
      snapshot->T_odom_robot = before;
      test::remember(*snapshot, map, before, 3.0);
      return localizer.update({snapshot, update.analysis});
    };
    look(before, 1);
    localizer.setPose(before);
    for (int i = 2; i < 40; ++i) look(before, i);
    for (int i = 0; i < 40; ++i) {
      if (errorOf(look(after, 40 + i), after) < 0.3) return i;
    }
    return 40;
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_LE(iterations(ObservationSource::kBoth, seed), iterations(ObservationSource::kImage, seed) + 3)
        << seed;
    EXPECT_LE(iterations(ObservationSource::kBoth, seed), 15) << seed;
  }
}

// A pose that explains nothing is not reliable, even without a rival.
TEST(Ablation, ReliabilityFallsWhenNothingIsExplained) {
  const SegmentMap map = test::corridorMap();
  Localizer localizer(
      defaultsBut([](LocalizerParams& p) { p.explorers.count_lost = p.explorers.count_reliable = 0; }), map,
      1);
  const Pose2 wrong{3.0, 2.5, 1.0};  // inside the block
  localizer.update(test::viewFrom(map, {6.9, 0, 0}, 200'000, 0.0, degToRad(-15), 3.0));
  localizer.setPose(wrong);
  for (int i = 2; i < 12; ++i) {
    MemoryUpdate update = test::viewFrom(map, {6.9, 0, 0}, i * 200'000, 0.0, degToRad(-15), 3.0);
    auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
    snapshot->T_odom_robot = {6.9, 0, 0};
    localizer.update({snapshot, update.analysis});
  }
  ASSERT_FALSE(localizer.latest().races.empty());
  EXPECT_LT(localizer.latest().reliability, 0.5);
}

// A mirrored map is a map of another place: races fit a part of each image, and none is right.
TEST(Ablation, ReliabilityIsLowInAMapOfAnotherPlace) {
  const auto line = [](double x1, double y1, double x2, double y2, const Label& label) {
    return MapSegment{{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
  };
  SegmentMap room;
  // No walls at right angles.
  room.segments = {line(-3, -2, 3, -1.2, "skirting"),     line(3, -1.2, 2.8, 0.2, "door"),
                   line(2.8, 0.2, 2.4, 2.5, "skirting"),  line(2.4, 2.5, -2.2, 1.6, "skirting"),
                   line(-2.2, 1.6, -2.7, -0.6, "door"),   line(-2.7, -0.6, -3, -2, "skirting"),
                   line(-1.2, -1.8, 0.2, -0.9, "stripe"), line(0.4, 1.6, 1.6, 0.2, "stripe")};
  SegmentMap mirrored = room;
  for (MapSegment& one : mirrored.segments) {
    one.world.a.y() *= -1.0;
    one.world.b.y() *= -1.0;
  }
  const auto meanReliability = [&](const SegmentMap& map, std::uint64_t seed) {
    Localizer localizer(localizerPreset(LocalizationMode::kDefault), map, seed);
    double sum = 0.0;
    for (int i = 0; i < 200; ++i) {
      const double turn = 0.02 * i;
      const Pose2 truth{0.8 * std::cos(turn), 0.8 * std::sin(turn), wrapAngle(turn + degToRad(90))};
      const double pan = degToRad(60) * std::sin(0.15 * i);
      localizer.update(test::viewFrom(room, truth, (i + 1) * 200'000, pan, degToRad(-15), 4.0));
      sum += localizer.latest().reliability / 200.0;
    }
    return sum;
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_GT(meanReliability(room, seed), 0.95) << seed;
    EXPECT_LT(meanReliability(mirrored, seed), 0.2) << seed;
  }
}

// Constructed explorers find the place more often than uniform ones with the same few tries.
TEST(Ablation, ConstructedExplorersNeedFewerTries) {
  const SegmentMap map = test::corridorMap();
  const Pose2 truth{6.9, 0.05, 0.1};
  const auto found = [&](double constructed_share) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Localizer localizer(defaultsBut([&](LocalizerParams& p) {
                            p.robust.explorers.constructed_share = constructed_share;
                            p.explorers.count_lost = p.explorers.count_reliable = 40;
                          }),
                          map, seed);
      MemoryUpdate update = test::viewFrom(map, truth, 200'000, 0.0, degToRad(-15), 3.0);
      auto snapshot = std::make_shared<MemorySnapshot>(*update.snapshot);
      test::remember(*snapshot, map, truth, 2.5);
      localizer.update({snapshot, update.analysis});
      for (const RaceReport& race : localizer.latest().races) {
        if ((race.T_world_robot.position() - truth.position()).norm() < 0.3) {
          ++count;
          break;
        }
      }
    }
    return count;
  };
  EXPECT_GE(found(1.0), 12);
  EXPECT_LE(found(0.0), 5);
}

// A turning robot with late images: odometry leads from the stamp of an image to now.
TEST(LocalizerProperty, LateImagesDoNotBiasTheHeading) {
  const SegmentMap map = test::corridorMap();
  const auto poseAt = [](double t) { return Pose2{6.6, 0.0, wrapAngle(0.3 * t)}; };
  for (const double latency_s : {0.1, 0.3, 1.0}) {
    Localizer localizer(localizerPreset(LocalizationMode::kDefault), map, 2);
    double sum = 0.0;
    int count = 0;
    for (int i = 1; i < 60; ++i) {
      const double t = 0.1 * i;
      const PoseEstimate estimate = localizer.update(
          test::viewFrom(map, poseAt(t), static_cast<StampUs>(1e5) * i, 0.0, degToRad(-15), 3.0));
      if (i == 1) localizer.setPose(poseAt(t));
      if (i < 20 || !estimate.T_world_robot) continue;
      // The present pose, predicted from the estimate by odometry.
      const Pose2 T_odom_now = poseAt(t + latency_s);
      const Pose2 now = *estimate.T_world_robot * inverse(estimate.T_odom_robot) * T_odom_now;
      sum += std::abs(angleDifference(now.theta, T_odom_now.theta));
      ++count;
    }
    ASSERT_GT(count, 30);
    EXPECT_LT(sum / count, degToRad(1.0)) << latency_s;
  }
}

}  // namespace
}  // namespace vismem
