// Tests E6.
#include "experiments/trials/twin_evidence.h"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

TEST(TwinEvidence, ComesWhenALineIsSeenThatTheTwinDoesNotHave) {
  // Two walls along y = 2 and y = -2, alike under half a turn, but one has a piece more at its end.
  SegmentMap map;
  map.segments = {{{{-4.0, 2.0, 0.0}, {4.0, 2.0, 0.0}}, "skirting", 0.0},
                  {{{4.0, -2.0, 0.0}, {-4.0, -2.0, 0.0}}, "skirting", 0.0},
                  {{{2.0, 1.0, 0.0}, {2.0, 2.0, 0.0}}, "door", 0.0},
                  {{{-2.0, -1.0, 0.0}, {-2.0, -2.0, 0.0}}, "other_door", 0.0},
                  {{{-3.0, 1.0, 0.0}, {-3.0, 2.0, 0.0}}, "other_door", 0.0}};
  MapIndex::Params index;
  index.direction_gate_rad = 0.35;
  const MapIndex fields(map, index);
  Trial trial;
  trial.events_us = {0};
  const Pose3 T_robot_camera =
      cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, -0.2);
  const CameraIntrinsics intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  for (int i = 0; i < 20; ++i) {
    const StampUs stamp_us = i * kSecondUs / 10;
    const Pose2 truth{0.0, 1.5, 0.0};
    append(trial.truth, {stamp_us, truth});
    auto analysis = std::make_shared<ImageAnalysis>();
    analysis->stamp_us = stamp_us;
    analysis->intrinsics = intrinsics;
    analysis->T_robot_camera = T_robot_camera;
    // The wall in all images; the door, which the twin place does not have, from the tenth image on.
    for (const int edge : {0, 2}) {
      if (edge == 2 && i < 10) continue;
      const auto px = projectSegment(intrinsics, toPose3(truth) * T_robot_camera,
                                     map.segments[static_cast<std::size_t>(edge)].world);
      ASSERT_TRUE(px);
      analysis->observed.push_back({*px, map.segments[static_cast<std::size_t>(edge)].label, 40.0});
    }
    auto snapshot = std::make_shared<MemorySnapshot>();
    snapshot->stamp_us = stamp_us;
    trial.updates.push_back({snapshot, analysis});
  }
  const auto evidence = evidenceAfter(trial, 0, {0.0, 0.0, std::numbers::pi}, fields);
  ASSERT_TRUE(evidence);
  // Half a metre is sufficient, and an image adds at most a quarter: the second image with the door.
  EXPECT_NEAR(*evidence, 1.1, 1e-6);
}

}  // namespace
}  // namespace vismem
