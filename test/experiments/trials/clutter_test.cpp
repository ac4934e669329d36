// Tests E6.
#include "experiments/trials/clutter.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

const CameraIntrinsics kIntrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));

/// 0.45 m above the floor, looking along x and a little down.
Pose3 camera() {
  return cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-15.0));
}

SegmentMap lines() {
  SegmentMap map;
  map.segments = {{{{1.0, 0.0, 0.0}, {3.0, 0.0, 0.0}}, "skirting", 0.0},
                  {{{2.0, -0.5, 0.0}, {2.0, 0.5, 0.0}}, "door_foot", 0.0},
                  {{{-1.0, 0.0, 0.0}, {-3.0, 0.0, 0.0}}, "skirting", 0.0}};
  return map;
}

/// Labelled segments across the image, as a detector finds them.
std::vector<ImageSegment> detected(int count) {
  std::vector<ImageSegment> image;
  for (int i = 0; i < count; ++i) {
    image.push_back({{{20.0, 20.0 + 5.0 * i}, {300.0, 20.0 + 5.0 * i}}, "skirting", 40.0});
  }
  return image;
}

TEST(Clutter, AddsTheShareOfFalseSegmentsOnTheFloorWithLabelsOfTheMap) {
  Clutter clutter({0.3, 0.0, 3.0}, lines());
  RandomEngine engine(1);
  double all = 0.0;
  double added = 0.0;
  for (int i = 0; i < 500; ++i) {
    std::vector<ImageSegment> image = detected(14);
    clutter.add(0.1 * i, kIntrinsics, camera(), engine, image);
    all += static_cast<double>(image.size());
    added += static_cast<double>(image.size() - 14);
    for (auto one = image.begin() + 14; one != image.end(); ++one) {
      EXPECT_TRUE(one->label == Label("skirting") || one->label == Label("door_foot"));
      EXPECT_GE(one->px.length(), Clutter::kLeast_px);
      // Beyond 4 m from the camera no object begins; the longest reaches 0.75 m further.
      const auto floor = backProjectToGround(kIntrinsics, camera(), 0.5 * (one->px.a + one->px.b), 5.0);
      EXPECT_TRUE(floor);
    }
  }
  EXPECT_NEAR(added / all, 0.3, 0.03);
}

TEST(Clutter, AnObjectStaysForItsTime) {
  Clutter clutter({0.5, 0.0, 3.0}, lines());
  RandomEngine engine(2);
  std::vector<ImageSegment> before = detected(6);
  clutter.add(0.0, kIntrinsics, camera(), engine, before);
  ASSERT_GT(before.size(), 6u);
  const auto seenAgain = [&](double time_s) {
    std::vector<ImageSegment> image = detected(6);
    clutter.add(time_s, kIntrinsics, camera(), engine, image);
    return std::count_if(image.begin() + 6, image.end(), [&](const ImageSegment& one) {
      return std::any_of(before.begin() + 6, before.end(), [&](const ImageSegment& old) {
        return (old.px.a - one.px.a).norm() < 1e-9 && (old.px.b - one.px.b).norm() < 1e-9;
      });
    });
  };
  EXPECT_GT(seenAgain(0.01), 0);
  EXPECT_EQ(seenAgain(120.0), 0);
}

TEST(Clutter, WithoutAShareNothingIsAddedOrDrawn) {
  Clutter clutter({}, lines());
  RandomEngine engine(3);
  RandomEngine same(3);
  std::vector<ImageSegment> image = detected(6);
  clutter.add(0.0, kIntrinsics, camera(), engine, image);
  EXPECT_EQ(image.size(), 6u);
  EXPECT_EQ(engine(), same());
}

TEST(LoseSegments, LosesTheShare) {
  RandomEngine engine(4);
  std::vector<ImageSegment> image = detected(10'000);
  loseSegments({0.0, 0.5, 3.0}, engine, image);
  EXPECT_NEAR(static_cast<double>(image.size()), 5000.0, 200.0);
}

}  // namespace
}  // namespace vismem
