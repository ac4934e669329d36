#include "active_visual_memory/core/segment_memory.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "active_visual_memory/core/floor_matching.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return m;
}

RobotObservation at(StampUs stamp_us, const Pose2& pose = {}, double pan_rad = 0.0, double tilt_rad = -0.35) {
  RobotObservation o;
  o.frame.stamp_us = stamp_us;
  o.frame.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  o.T_odom_robot = pose;
  o.pan_tilt = PanTilt{pan_rad, tilt_rad};
  o.T_robot_camera = cameraPose(mount(), pan_rad, tilt_rad);
  return o;
}

std::vector<ImageSegment> images(const RobotObservation& o, const std::vector<Segment3>& world) {
  std::vector<ImageSegment> seen;
  const Pose3 T = toPose3(o.T_odom_robot) * o.T_robot_camera;
  for (const Segment3& s : world) {
    if (const auto px = projectSegment(o.frame.intrinsics, T, s)) seen.push_back({*px, "edge", 40.0});
  }
  return seen;
}

AttentiveVisualMemoryParams standard() {
  AttentiveVisualMemoryParams p = AttentiveVisualMemoryParams::standard();
  p.gaze.mount = mount();
  p.gaze.initial_mode = GazeMode::kOff;
  return p;
}

const std::vector<Segment3> kCross{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}, {{1.2, 0.2, 0}, {1.8, 0.2, 0}}};

TEST(SegmentMemory, RemembersWhatItSawAndPredictsIt) {
  AttentiveVisualMemory memory(standard());
  AttentiveVisualMemory::StepResult result;
  for (int i = 0; i < 5; ++i) {
    const auto o = at(i * 33'333);
    result = memory.step(o, images(o, kCross));
  }
  ASSERT_EQ(result.update.snapshot->segments.size(), 2u);
  EXPECT_EQ(result.update.snapshot->revision, 5u);
  EXPECT_EQ(result.update.analysis->predicted.size(), 2u);
  EXPECT_EQ(result.update.analysis->matches.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR((result.update.snapshot->segments[i].odom.a - kCross[i].a).norm(), 0.0, 1e-6);
    EXPECT_NEAR((result.update.snapshot->segments[i].odom.b - kCross[i].b).norm(), 0.0, 1e-6);
    EXPECT_EQ(result.update.snapshot->segments[i].label, "edge");
  }
}

TEST(SegmentMemory, StaysStillInTheWorldWhileTheRobotDrivesTowardsWhatItSees) {
  // Exact images and exact odometry on arcs of 0.6 m to either side: neither fusion nor the correction of
  // odometry's drift may move anything by more than a millimetre, in any image.
  const std::vector<Segment3> world{
      {{2.0, -0.4, 0}, {2.0, 0.4, 0}}, {{1.6, 0.5, 0}, {2.4, 0.6, 0}}, {{1.5, -0.7, 0}, {2.5, -0.5, 0}}};
  for (const double turn_per_m : {-0.5, -0.2, 0.0, 0.3, 0.5}) {
    AttentiveVisualMemory memory(standard());
    Pose2 pose;
    AttentiveVisualMemory::StepResult result;
    for (int i = 0; i < 60; ++i) {
      if (i >= 10) pose = pose * Pose2{0.012, 0.0, turn_per_m * 0.012};
      const auto o = at(i * 33'333, pose);
      result = memory.step(o, images(o, world));
      if (i < 3) continue;
      ASSERT_EQ(result.update.snapshot->segments.size(), world.size()) << turn_per_m << ", image " << i;
      for (std::size_t k = 0; k < world.size(); ++k) {
        const Segment2 truth = world[k].floor();
        const Segment2 known = result.update.snapshot->segments[k].odom.floor();
        EXPECT_LT(distanceToLine(known.a, truth), 1e-3) << turn_per_m << ", image " << i;
        EXPECT_LT(distanceToLine(known.b, truth), 1e-3) << turn_per_m << ", image " << i;
      }
    }
    EXPECT_TRUE(result.update.snapshot->segments.front().confirmed) << turn_per_m;
  }
}

TEST(SegmentMemory, StaysStillInTheWorldUnderPureMotion) {
  // The robot drives and turns with its eyes away from what it knows; odom places must not move at all, and
  // back in view the memory predicts them where they are.
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.step(o, images(o, kCross));
  }
  const Segment3 before = memory.elements()[0].value.odom;
  for (int i = 0; i < 60; ++i, t += 33'333)
    memory.step(at(t, {0.005 * i, 0.0, 0.02 * i}, degToRad(150.0)), {});
  ASSERT_EQ(memory.elements().size(), 2u);
  EXPECT_EQ(memory.elements()[0].value.odom.a, before.a);
  EXPECT_EQ(memory.elements()[0].value.odom.b, before.b);
  const auto o = at(t, {0.1, 0.05, 0.1});
  const auto result = memory.step(o, images(o, kCross));
  EXPECT_EQ(result.update.analysis->matches.size(), 2u);
  EXPECT_EQ(memory.elements().size(), 2u);
}

TEST(SegmentMemory, FragmentsOfAKnownLineDoNotBecomeDuplicates) {
  AttentiveVisualMemory memory(standard());
  const std::vector<Segment3> whole{kCross[0]};
  const std::vector<Segment3> pieces{{{1.0, -0.3, 0}, {1.0, -0.05, 0}}, {{1.0, 0.05, 0}, {1.0, 0.3, 0}}};
  StampUs t = 0;
  for (int i = 0; i < 40; ++i, t += 33'333) {
    const auto o = at(t);
    memory.step(o, images(o, i % 2 ? pieces : whole));
  }
  ASSERT_EQ(memory.elements().size(), 1u);
  EXPECT_NEAR(memory.elements()[0].value.odom.length(), 0.6, 0.01);
}

TEST(SegmentMemory, PiecesSeenFirstAreJoinedWhenTheWholeIsSeen) {
  AttentiveVisualMemory memory(standard());
  const std::vector<Segment3> pieces{{{1.0, -0.3, 0}, {1.0, -0.1, 0}}, {{1.0, 0.1, 0}, {1.0, 0.3, 0}}};
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.step(o, images(o, pieces));
  }
  EXPECT_EQ(memory.elements().size(), 2u);
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.step(o, images(o, {kCross[0]}));
  }
  EXPECT_EQ(memory.elements().size(), 1u);
}

TEST(SegmentMemory, ALineLongerThanTheImageGrowsAsTheCameraPans) {
  AttentiveVisualMemory memory(standard());
  const std::vector<Segment3> wall{{{1.2, -2.0, 0}, {1.2, 2.0, 0}}};
  StampUs t = 0;
  for (int i = 0; i <= 120; ++i, t += 33'333) {
    const auto o = at(t, {}, degToRad(-60.0 + i));
    memory.step(o, images(o, wall));
  }
  ASSERT_EQ(memory.elements().size(), 1u);
  const MemoryElement& e = memory.elements()[0];
  EXPECT_NEAR(std::abs(e.value.odom.a.y()), 2.0, 0.03);
  EXPECT_NEAR(std::abs(e.value.odom.b.y()), 2.0, 0.03);
  EXPECT_FALSE(e.line.endA().open);
  EXPECT_FALSE(e.line.endB().open);
}

/// Renders a floor: dark above the far edge of a marking, bright nearer, or plain.
cv::Mat picture(bool marking, int grey_cover = -1) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  if (marking) image.rowRange(110, 240).setTo(cv::Scalar(180, 180, 180));
  if (grey_cover >= 0) image.setTo(cv::Scalar(grey_cover, 0, grey_cover));
  return image;
}

struct Life {
  double seconds_alive;
  std::size_t left;
};
Life afterwards(const cv::Mat& later, double seconds) {
  AttentiveVisualMemory memory(standard());
  // The edge between row 109 and 110, brighter below: walking to the left of the picture, left is down.
  const std::vector<ImageSegment> edge{{{{250, 109.5}, {70, 109.5}}, "edge", 120.0}};
  StampUs t = 0;
  for (int i = 0; i < 60; ++i, t += 33'333) {
    auto o = at(t);
    o.frame.image = picture(true);
    memory.step(o, edge);
  }
  EXPECT_EQ(memory.elements().size(), 1u);
  const StampUs begin = t;
  while (toSeconds(t - begin) < seconds && !memory.elements().empty()) {
    auto o = at(t);
    o.frame.image = later;
    memory.step(o, {});
    t += 33'333;
  }
  return {toSeconds(t - begin), memory.elements().size()};
}

TEST(SegmentMemory, WhatIsGoneIsForgottenWithinTwoSecondsOfABareView) {
  const Life life = afterwards(picture(false), 10.0);
  EXPECT_EQ(life.left, 0u);
  EXPECT_LE(life.seconds_alive, 2.0);
}

TEST(SegmentMemory, AnOcclusionFreezesLife) {
  EXPECT_EQ(afterwards(picture(false, 200), 30.0).left, 1u);
}

TEST(SegmentMemory, AnEdgeTheDetectorMissesStays) {
  EXPECT_EQ(afterwards(picture(true), 30.0).left, 1u);
}

TEST(SegmentMemory, ANewEpochSetsTheMemoryAside) {
  AttentiveVisualMemory memory(standard());
  StampUs t = 0;
  for (int i = 0; i < 5; ++i, t += 33'333) {
    const auto o = at(t);
    memory.step(o, images(o, kCross));
  }
  const std::uint64_t last_id = memory.elements().back().value.id;
  auto o = at(t);
  o.epoch = 1;
  const auto result = memory.step(o, images(o, {kCross[0]}));
  ASSERT_EQ(memory.elements().size(), 1u);
  EXPECT_GT(memory.elements()[0].value.id, last_id);
  EXPECT_EQ(result.update.snapshot->epoch, 1u);
}

TEST(SegmentMemory, StaysWithinItsBound) {
  AttentiveVisualMemoryParams p = standard();
  p.memory.max_elements = 5;
  AttentiveVisualMemory memory(p);
  std::vector<Segment3> many;
  for (int i = 0; i < 10; ++i) many.push_back({{0.8 + 0.15 * i, -0.2, 0}, {0.8 + 0.15 * i, 0.2, 0}});
  for (int i = 0; i < 10; ++i) {
    const auto o = at(i * 33'333);
    memory.step(o, images(o, many));
    EXPECT_LE(memory.elements().size(), 5u);
  }
}

TEST(SegmentMemory, CleansTheDuplicatesOfOneImage) {
  FloorSegment a;
  a.odom = {{0, 0}, {1, 0}};
  a.label = "edge";
  a.strength = 40.0;
  FloorSegment copy = a;
  copy.odom = {{0.5, 0.01}, {1.2, 0.01}};
  FloorSegment other = a;
  other.odom = {{0, 0.3}, {1, 0.3}};
  FloorSegment opposite = a;
  opposite.odom = {{1, 0.01}, {0, 0.01}};
  const auto clean = cleanDuplicates({a, copy, other, opposite}, 0.06, 0.03, 0.03);
  ASSERT_EQ(clean.size(), 3u) << "the other polarity is another edge";
  EXPECT_NEAR(clean[0].odom.b.x(), 1.2, 1e-9);
  EXPECT_NEAR(clean[0].odom.b.y(), 0.0, 1e-9);
}

TEST(FrameGate, OpensOnMotionTurnAndTime) {
  FrameGate::Params p;
  p.enabled = true;
  FrameGate gate(p);
  EXPECT_TRUE(gate.opens(at(0)));
  gate.passed(at(0));
  EXPECT_FALSE(gate.opens(at(33'333)));
  EXPECT_TRUE(gate.opens(at(33'333, {0.03, 0, 0})));
  EXPECT_TRUE(gate.opens(at(33'333, {}, 0.03)));
  EXPECT_TRUE(gate.opens(at(200'000)));
  p.enabled = false;
  EXPECT_TRUE(FrameGate(p).opens(at(33'333)));
}

TEST(FrameGate, AGlanceKeepsTheRevision) {
  AttentiveVisualMemory memory(standard());
  const auto first = memory.step(at(0), {});
  const auto glance = memory.glance(at(33'333));
  EXPECT_EQ(glance.update.snapshot, first.update.snapshot);
  EXPECT_EQ(memory.step(at(66'666), {}).update.snapshot->revision, 2u);
}

TEST(SegmentMemory, MakesTwoOfALineInWhichImagesShowAGap) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gap_votes = 3;
  AttentiveVisualMemory memory(params);
  AttentiveVisualMemory::StepResult result;
  StampUs t = 0;
  const std::vector<Segment3> whole{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}};
  const std::vector<Segment3> parted{{{1.0, -0.3, 0}, {1.0, 0.05, 0}}, {{1.0, 0.10, 0}, {1.0, 0.3, 0}}};
  cv::Mat image;
  const auto show = [&](const std::vector<Segment3>& world, int times) {
    for (int i = 0; i < times; ++i, t += 33'333) {
      auto o = at(t);
      o.frame.image = image;
      result = memory.step(o, images(o, world));
    }
  };
  show(whole, 5);
  show(parted, 10);
  ASSERT_EQ(memory.elements().size(), 1U) << "a break of the detector's is none";
  image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(200));  // nothing in it where it is looked at
  show(parted, 10);
  ASSERT_EQ(memory.elements().size(), 2U);
  // A worse image that bridges the gap does not join them again.
  show(whole, 5);
  ASSERT_EQ(memory.elements().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto near = [&](const Eigen::Vector2d& p, const Eigen::Vector3d& q) {
      return (p - q.head<2>()).norm() < 0.01;
    };
    const Segment2 known = memory.elements()[i].value.odom.floor();
    EXPECT_TRUE(std::any_of(parted.begin(), parted.end(),
                            [&](const Segment3& s) { return near(known.a, s.a) && near(known.b, s.b); }))
        << known.a.transpose() << " .. " << known.b.transpose();
  }
}

TEST(SegmentMemory, PartsALineAtEachOfItsGaps) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gap_votes = 3;
  AttentiveVisualMemory memory(params);
  StampUs t = 0;
  const std::vector<Segment3> whole{{{1.3, -0.6, 0}, {1.3, 0.6, 0}}};
  const std::vector<Segment3> parted{
      {{1.3, -0.6, 0}, {1.3, -0.25, 0}}, {{1.3, -0.20, 0}, {1.3, 0.20, 0}}, {{1.3, 0.25, 0}, {1.3, 0.6, 0}}};
  const auto show = [&](const std::vector<Segment3>& world, int times) {
    for (int i = 0; i < times; ++i, t += 33'333) {
      auto o = at(t);
      o.frame.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(200));
      memory.step(o, images(o, world));
    }
  };
  show(whole, 5);
  ASSERT_EQ(memory.elements().size(), 1U);
  show(parted, 10);
  ASSERT_EQ(memory.elements().size(), 3U);
  for (const Segment3& truth : parted) {
    EXPECT_TRUE(std::any_of(memory.elements().begin(), memory.elements().end(), [&](const MemoryElement& e) {
      return (e.value.odom.a - truth.a).norm() < 0.01 && (e.value.odom.b - truth.b).norm() < 0.01;
    })) << truth.a.transpose();
  }
}

TEST(SegmentMemory, KeepsTwoEdgesThatABlurredImageRunsTogether) {
  const std::vector<Segment3> whole{{{1.0, -0.3, 0}, {1.0, 0.3, 0}}};
  const std::vector<Segment3> two{{{1.0, -0.3, 0}, {1.0, 0.0, 0}}, {{1.0, 0.08, 0}, {1.0, 0.3, 0}}};
  for (const int votes : {0, 3}) {
    AttentiveVisualMemoryParams params = standard();
    params.memory.gap_votes = votes;
    AttentiveVisualMemory memory(params);
    for (int i = 0; i < 15; ++i) {
      const auto o = at(i * 33'333);
      memory.step(o, images(o, i < 10 ? two : whole));
    }
    EXPECT_EQ(memory.elements().size(), votes > 0 ? 2U : 1U) << votes;
  }
}

/// How many elements a line becomes of which something hides a piece from either of two places.
std::size_t elementsWhenHidden(double from_left_m, double from_right_m) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.gap_votes = 3;
  AttentiveVisualMemory memory(params);
  StampUs t = 0;
  for (const auto& [y, hidden] : {std::pair(0.25, from_left_m), std::pair(-0.25, from_right_m)}) {
    const std::vector<Segment3> seen{{{1.5, -0.5, 0}, {1.5, hidden - 0.05, 0}},
                                     {{1.5, hidden + 0.05, 0}, {1.5, 0.5, 0}}};
    for (int i = 0; i < 10; ++i, t += 33'333) {
      auto o = at(t, {0.0, y, 0.0});
      auto observed = images(o, seen);
      if (t < 100'000) observed = images(o, {{{1.5, -0.5, 0}, {1.5, 0.5, 0}}});
      cv::Mat image(240, 320, CV_8UC1, cv::Scalar(200));
      const Pose3 T = toPose3(o.T_odom_robot) * o.T_robot_camera;
      const auto px = projectSegment(o.frame.intrinsics, T, {seen[0].b, seen[1].a});
      const auto [left, right] = std::minmax(px->a.x(), px->b.x());
      image(cv::Rect(cv::Point(static_cast<int>(left), static_cast<int>(px->a.y()) - 20),
                     cv::Point(static_cast<int>(right) + 1, static_cast<int>(px->a.y()) + 20))) = 60;
      o.frame.image = image;
      memory.step(o, observed);
    }
  }
  return memory.elements().size();
}

TEST(SegmentMemory, WhatHidesAPlaceFromEverywhereStandsThere) {
  EXPECT_EQ(elementsWhenHidden(0.1, 0.1), 2U);
  EXPECT_EQ(elementsWhenHidden(0.0, 0.2), 1U) << "the line goes on behind what stands before it";
}

/// Two far lines, 6 px apart in the image, and near ones that tell them apart.
const std::vector<Segment3> kLadder{{{2.20, -0.8, 0}, {2.20, 0.8, 0}}, {{2.50, -0.8, 0}, {2.50, 0.8, 0}},
                                    {{0.90, -0.3, 0}, {0.90, 0.3, 0}}, {{1.10, -0.4, 0}, {1.10, 0.4, 0}},
                                    {{1.35, -0.5, 0}, {1.35, 0.5, 0}}, {{1.0, 0.35, 0}, {1.8, 0.35, 0}},
                                    {{1.0, -0.35, 0}, {1.8, -0.35, 0}}};

/// @return matched segments per image of a body that nods by 0.8 degrees.
double matchedWhileNodding(AttentiveVisualMemory& memory) {
  int matches = 0;
  constexpr int kImages = 40;
  for (int i = 0; i < 20 + kImages; ++i) {
    const auto o = at(i * 33'333);
    RobotObservation really = o;
    if (i >= 20) {
      const double nod = degToRad(i % 2 == 0 ? 0.8 : -0.8);
      really.T_robot_camera = leaned(o.T_robot_camera, Lean(0.0, nod, 0.0, 0.0));
    }
    const auto result = memory.step(o, images(really, kLadder));
    if (i >= 20) matches += static_cast<int>(result.update.analysis->matches.size());
  }
  return static_cast<double>(matches) / kImages;
}

TEST(SegmentMemory, ABodyThatSwaysMeetsItsMemoryWhereTheSwayPutsIt) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.lean.sway_rad = degToRad(1.0);
  params.projector.pitch_sigma_rad = degToRad(1.0);
  AttentiveVisualMemory memory(params);
  EXPECT_GT(matchedWhileNodding(memory), 6.9);
  EXPECT_EQ(memory.elements().size(), kLadder.size()) << "nothing is remembered twice";
  for (const Segment3& truth : kLadder) {
    EXPECT_TRUE(std::any_of(memory.elements().begin(), memory.elements().end(), [&](const MemoryElement& e) {
      return (e.value.odom.a - truth.a).norm() < 0.05 && (e.value.odom.b - truth.b).norm() < 0.05;
    })) << truth.a.transpose();
  }

  params.memory.sway_to_meet_twice_rad = 1.0;  // never
  AttentiveVisualMemory once(params);
  EXPECT_LT(matchedWhileNodding(once), 6.9) << "these images tell nothing of meeting twice";
}

}  // namespace
}  // namespace vismem
