// Tests M6.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "active_visual_memory/memory_scene.h"

namespace vismem {
namespace {

TEST(SegmentMemoryAlignment, StaysStillInTheWorldWhileTheRobotDrivesTowardsWhatItSees) {
  // Exact images and exact odometry on arcs of 0.6 m to either side: neither fusion nor the correction of
  // odometry's drift may move anything by more than a millimetre, in any image.
  const std::vector<Segment3> world{{{2.0, -0.4, 0}, {2.0, 0.4, 0}},
                                    {{1.6, 0.5, 0}, {2.4, 0.6, 0}},
                                    {{1.5, -0.7, 0}, {2.5, -0.5, 0}},
                                    {{2.9, -1.0, 0}, {2.8, 1.0, 0}}};
  for (const double turn_per_m : {-0.5, -0.2, 0.0, 0.3, 0.5}) {
    AttentiveVisualMemory memory(standard());
    Pose2 pose;
    AttentiveVisualMemory::StepResult result;
    for (int i = 0; i < 90; ++i) {
      if (i >= 10) pose = pose * Pose2{0.012, 0.0, turn_per_m * 0.012};
      const auto o = at(i * 33'333, pose);
      result = memory.update(o, images(o, world));
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

/// Two far lines, 6 px apart in the image, and near ones that tell them apart.
const std::vector<Segment3> kLadder{{{2.20, -0.8, 0}, {2.20, 0.8, 0}}, {{2.50, -0.8, 0}, {2.50, 0.8, 0}},
                                    {{0.90, -0.3, 0}, {0.90, 0.3, 0}}, {{1.10, -0.4, 0}, {1.10, 0.4, 0}},
                                    {{1.35, -0.5, 0}, {1.35, 0.5, 0}}, {{1.0, 0.35, 0}, {1.8, 0.35, 0}},
                                    {{1.0, -0.35, 0}, {1.8, -0.35, 0}}};

/// @return matched segments per image of a body that nods by 1 degree.
double matchedWhileNodding(AttentiveVisualMemory& memory) {
  int matches = 0;
  constexpr int kImages = 40;
  for (int i = 0; i < 20 + kImages; ++i) {
    const auto o = at(i * 33'333);
    RobotObservation really = o;
    if (i >= 20) {
      const double nod = degToRad(i % 2 == 0 ? 1.0 : -1.0);
      really.T_robot_camera = tilted(o.T_robot_camera, CameraTilt(0.0, nod, 0.0, 0.0));
    }
    const auto result = memory.update(o, images(really, kLadder));
    if (i >= 20) matches += static_cast<int>(result.update.analysis->matches.size());
  }
  return static_cast<double>(matches) / kImages;
}

TEST(SegmentMemoryAlignment, ALeggedRobotAssociatesAgainAfterTheFirstCorrection) {
  AttentiveVisualMemoryParams params = standard();
  params.memory.estimation.tilt_prior.per_frame_rad = degToRad(1.0);
  params.projector.pitch_sigma_rad = degToRad(1.0);
  params.memory.estimation.map_filter.gait_height_m = 0.0;  // the camera nods about itself
  AttentiveVisualMemory memory(params);
  EXPECT_GT(matchedWhileNodding(memory), 6.9);
  EXPECT_EQ(memory.elements().size(), kLadder.size()) << "nothing is remembered twice";
  for (const Segment3& truth : kLadder) {
    EXPECT_TRUE(std::any_of(memory.elements().begin(), memory.elements().end(), [&](const MemoryElement& e) {
      return (e.value.odom.a - truth.a).norm() < 0.05 && (e.value.odom.b - truth.b).norm() < 0.05;
    })) << truth.a.transpose();
  }

  params.memory.estimation.min_legged_tilt_rad = 1.0;  // never
  AttentiveVisualMemory once(params);
  EXPECT_LT(matchedWhileNodding(once), 6.8) << "these images need the second association";
}

}  // namespace
}  // namespace vismem
