// Tests A1, A2, A3, A6.
#include "active_visual_memory/core/gaze/attention.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "active_visual_memory/published_attention.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr StampUs kTick = 200'000;

MemorySegment segmentAt(std::uint64_t id, double angle_deg) {
  MemorySegment s;
  s.id = id;
  const Eigen::Vector3d p{1.5 * std::cos(degToRad(angle_deg)), 1.5 * std::sin(degToRad(angle_deg)), 0.0};
  s.odom = {p - Eigen::Vector3d(0.05, 0, 0), p + Eigen::Vector3d(0.05, 0, 0)};
  return s;
}

AttentionPool::Params quiet() {
  AttentionPool::Params p;
  p.look_around_first = false;
  p.forced_search_s = 1000.0;
  p.max_forced_search_s = 1000.0;
  return p;
}

TEST(Attention, SalienceGrowsByOnePerTickAndIsZeroAfterAVisit) {
  AttentionPool pool(quiet(), Rig{});
  const std::vector<MemorySegment> memory{segmentAt(5, 0), segmentAt(6, 90)};
  for (int i = 0; i <= 10; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, {});
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 5), 10.0);
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 6), 10.0);
  const auto first = pool.mostSalient();
  ASSERT_TRUE(first);
  pool.visited(first->id, panTiltTowards({}, *first->p_odom), {});
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, *pool.segmentOf(first->id)), 0.0);
  // The other one lies 90 degrees away and is next: inhibition of return.
  EXPECT_DOUBLE_EQ(pool.mostSalient()->salience, 10.0);
  EXPECT_NE(pool.mostSalient()->id, first->id);
}

TEST(Attention, TheAttendedPointDoesNotGrow) {
  AttentionPool pool(quiet(), Rig{});
  const std::vector<MemorySegment> memory{segmentAt(5, 0)};
  for (int i = 0; i <= 5; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, {});
  const auto id = pool.mostSalient()->id;
  for (int i = 6; i <= 20; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, id);
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 5), 5.0);
}

TEST(Attention, AVisitRefreshesWhatLiesNear) {
  AttentionPool pool(quiet(), Rig{});
  const std::vector<MemorySegment> memory{segmentAt(1, 0), segmentAt(2, 8), segmentAt(3, 40)};
  for (int i = 0; i <= 10; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, {});
  pool.visited(pool.mostSalient()->id, {0.0, 0.0}, {});
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 1), 0.0);
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 2), 0.0);
  EXPECT_GT(salienceOf(pool, AttentionKind::kSegment, 3), 0.0);
}

TEST(Attention, VisitsFollowTheGrowthRatesOfClients) {
  // Three clients, rates 1 : 2 : 4, one visit per tick: visits in the same proportion.
  AttentionPool pool(quiet(), Rig{});
  std::map<double, int> visits;
  const std::map<double, double> pan{{1.0, -2.0}, {2.0, 0.0}, {4.0, 2.0}};
  for (const auto& [rate, direction] : pan) {
    GazeRequest request;
    request.client = "test";
    request.key = std::to_string(rate);
    request.direction = PanTilt{direction, 0.0};
    request.priority = rate;
    request.deadline_us = 10'000 * kTick;
    pool.request(request);
  }
  for (int i = 0; i < 2000; ++i) {
    pool.update(i * kTick, {}, {}, {});
    const auto next = pool.mostSalient();
    if (!next || next->salience < 8.0) continue;
    for (const auto& [rate, direction] : pan) {
      if (next->direction->pan_rad == direction) ++visits[rate];
    }
    pool.visited(next->id, *next->direction, {});
  }
  EXPECT_NEAR(visits[2.0], 2.0 * visits[1.0], 0.25 * 2.0 * visits[1.0]);
  EXPECT_NEAR(visits[4.0], 4.0 * visits[1.0], 0.25 * 4.0 * visits[1.0]);
}

TEST(Attention, RatesChangeForWaitingPointsToo) {
  AttentionPool pool(quiet(), Rig{});
  const std::vector<MemorySegment> memory{segmentAt(5, 0)};
  GazeRequest request;
  request.client = "test";
  request.direction = PanTilt{1.0, 0.0};
  request.priority = 2.0;
  request.deadline_us = 100 * kTick;
  pool.request(request);
  const auto salienceOfClient = [&] {
    for (const AttentionPoint& point : pointsOf(pool)) {
      if (point.kind == AttentionKind::kClient) return point.salience;
    }
    return -1.0;
  };
  for (int i = 0; i <= 10; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, {});
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 5), 10.0);
  EXPECT_DOUBLE_EQ(salienceOfClient(), 20.0);
  pool.setRate(AttentionKind::kSegment, 3.0);
  pool.setRate(AttentionKind::kClient, 0.5);
  for (int i = 11; i <= 20; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, {});
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kSegment, 5), 40.0) << "10 + 10 ticks * 3";
  EXPECT_DOUBLE_EQ(salienceOfClient(), 30.0) << "20 + 10 ticks * 0.5 * priority 2";
}

TEST(Attention, ForcedSearchComesLessOftenTheMoreIsKnown) {
  AttentionPool::Params p = quiet();
  p.forced_search_s = 5.0;
  p.max_forced_search_s = 20.0;
  const auto firstScan_s = [&](int objects) {
    AttentionPool pool(p, Rig{});
    std::vector<MemorySegment> memory;
    for (int i = 0; i < objects; ++i) memory.push_back(segmentAt(i + 1, 30.0 * i));
    for (StampUs t = 0;; t += 50'000) {
      pool.update(t, {memory, {}, {}}, {}, {});
      for (const auto& point : pointsOf(pool)) {
        if (point.kind == AttentionKind::kScanning) return toSeconds(t);
      }
    }
  };
  EXPECT_NEAR(firstScan_s(0), 5.0, 0.06);
  EXPECT_NEAR(firstScan_s(5), 10.0, 0.06);
  EXPECT_NEAR(firstScan_s(12), 17.0, 0.06);
  EXPECT_NEAR(firstScan_s(40), 17.0, 0.06) << "in 12 directions";
  p.count_groups = false;
  EXPECT_NEAR(firstScan_s(12), 17.0, 0.06);
  EXPECT_NEAR(firstScan_s(40), 20.0, 0.06) << "at the latest";
  p.forced_search_s = 30.0;
  EXPECT_NEAR(firstScan_s(0), 20.0, 0.06);
}

TEST(Attention, ScanningPointsLeadAndGoAfterTheirVisit) {
  AttentionPool pool(quiet(), Rig{});
  const std::vector<MemorySegment> memory{segmentAt(1, 0)};
  for (int i = 0; i <= 50; ++i) pool.update(i * kTick, {memory, {}, {}}, {}, {});
  pool.addScanningPoint();
  pool.addScanningPoint();
  EXPECT_EQ(pool.size(), 2u) << "one scanning point waits at most";
  const auto next = pool.mostSalient();
  ASSERT_EQ(next->kind, AttentionKind::kScanning);
  pool.visited(next->id, *next->direction, {});
  EXPECT_EQ(pool.size(), 1u);
}

TEST(Attention, TheSystematicPatternCoversTheWholeRangeAndRepeats) {
  AttentionPool::Params p = quiet();
  p.scan_min_tilt_rad = -0.541;
  p.scan_max_tilt_rad = 0.541;
  AttentionPool pool(p, Rig{});
  std::vector<PanTilt> seen;
  for (int i = 0; i < 60; ++i) {
    pool.addScanningPoint();
    const auto point = *pool.mostSalient();
    seen.push_back(*point.direction);
    pool.visited(point.id, *point.direction, {});
  }
  for (double pan = Rig{}.min_pan_rad; pan <= Rig{}.max_pan_rad; pan += 0.1) {
    for (double tilt = Rig{}.min_tilt_rad; tilt <= Rig{}.max_tilt_rad; tilt += 0.1) {
      double nearest = 10.0;
      for (const PanTilt& s : seen) {
        nearest = std::min(nearest, std::max(std::abs(s.pan_rad - pan), std::abs(s.tilt_rad - tilt)));
      }
      // Half a step, well inside 60 x 47 degrees of view.
      EXPECT_LE(nearest, 0.36);
    }
  }
}

TEST(Attention, RandomScanningPointsStayInRangeAndFollowTheSeed) {
  AttentionPool::Params p = quiet();
  p.scanning = AttentionPool::Scanning::kRandom;
  p.scan_min_tilt_rad = -0.5;
  p.scan_max_tilt_rad = 0.2;
  AttentionPool a(p, Rig{});
  AttentionPool b(p, Rig{});
  for (int i = 0; i < 200; ++i) {
    a.addScanningPoint();
    b.addScanningPoint();
    const auto x = *a.mostSalient();
    EXPECT_EQ(*x.direction, *b.mostSalient()->direction);
    EXPECT_GE(x.direction->pan_rad, Rig{}.min_pan_rad);
    EXPECT_LE(x.direction->pan_rad, Rig{}.max_pan_rad);
    EXPECT_GE(x.direction->tilt_rad, p.scan_min_tilt_rad);
    EXPECT_LE(x.direction->tilt_rad, p.scan_max_tilt_rad);
    a.visited(x.id, *x.direction, {});
    b.visited(b.mostSalient()->id, *x.direction, {});
  }
}

TEST(Attention, RequestsEndAtTheirDeadlineAndWhenWithdrawn) {
  AttentionPool pool(quiet(), Rig{});
  GazeRequest request;
  request.client = "c";
  request.key = "k";
  request.direction = PanTilt{};
  request.deadline_us = 10 * kTick;
  pool.request(request);
  pool.request(request);
  EXPECT_EQ(pool.size(), 1u) << "the same client and key replace the old one";
  pool.update(10 * kTick, {}, {}, {});
  EXPECT_EQ(pool.size(), 1u);
  pool.update(11 * kTick, {}, {}, {});
  EXPECT_EQ(pool.size(), 0U);
  request.deadline_us = 100 * kTick;
  pool.request(request);
  pool.withdraw("c", "k");
  EXPECT_EQ(pool.size(), 0U);
}

TEST(Attention, AnUrgentRequestIsTheMostSalientPointAtOnce) {
  AttentionPool pool(quiet(), Rig{});
  pool.addScanningPoint();
  for (int i = 0; i < 1000; ++i) pool.update(i * kTick, {}, {}, {});
  EXPECT_FALSE(pool.isUrgent());
  GazeRequest request;
  request.client = "c";
  request.key = "k";
  request.direction = PanTilt{};
  request.deadline_us = 10'000 * kTick;
  request.priority = kUrgentPriority - 1.0;
  pool.request(request);
  EXPECT_EQ(pool.mostSalient()->kind, AttentionKind::kScanning) << "it grows";
  request.priority = kUrgentPriority;
  pool.request(request);
  EXPECT_EQ(pool.mostSalient()->kind, AttentionKind::kClient) << "at once";
  EXPECT_TRUE(pool.isUrgent());
}

TEST(Attention, ALongWallIsLookedAtWhereItIsNear) {
  // A wall along x at y = 1 from -10 to 10, seen from the origin within 2 m: the middle of what is near.
  const Eigen::Vector3d p = focusOf({{-10, 1, 0}, {10, 1, 0}}, {0, 0}, 2.0);
  EXPECT_NEAR((p - Eigen::Vector3d(0, 1, 0)).norm(), 0.0, 1e-9);
  // Out of reach: the nearest point.
  EXPECT_NEAR((focusOf({{5, 0, 0}, {10, 0, 0}}, {0, 0}, 2.0) - Eigen::Vector3d(5, 0, 0)).norm(), 0.0, 1e-9);
}

TEST(Attention, SegmentsShapesAndHypothesesCompeteAndAHypothesisStartsFirst) {
  AttentionPool pool(quiet(), Rig{});
  const std::vector<MemorySegment> segments{segmentAt(1, 0)};
  std::vector<Primitive> shapes(2);
  shapes[0].id = 7;
  shapes[0].kind = PrimitiveKind::kCircle;
  shapes[0].centre = {0.0, 1.5};
  shapes[1].id = 8;
  shapes[1].kind = PrimitiveKind::kStripe;
  for (int i = 0; i <= 10; ++i) pool.update(i * kTick, {segments, shapes, {}}, {}, {});
  EXPECT_EQ(pool.size(), 2u) << "a stripe competes as its segments";
  EXPECT_DOUBLE_EQ(salienceOf(pool, AttentionKind::kPrimitive, 7), 10.0);
  const std::vector<VertexHypothesis> corners{{7, {-1.5, 0.0}}};
  pool.update(11 * kTick, {segments, shapes, corners}, {}, {});
  const auto next = pool.mostSalient();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->kind, AttentionKind::kHypothesis);
  // The points before this update had 10; it starts 1 above and has grown by 2.
  EXPECT_DOUBLE_EQ(next->salience, 10.0 + 1.0 + 2.0);
}

}  // namespace
}  // namespace vismem
