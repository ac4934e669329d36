// Tests L4.
#include "localization/core/map/segment_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/geometry/angles.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

CameraIntrinsics camera() {
  return intrinsicsFromFieldOfView(320, 240, degToRad(60));
}

/// A camera at (x, y, z) that looks along a pan and tilt.
Pose3 cameraAt(const Eigen::Vector3d& p, double pan_rad, double tilt_rad) {
  Pose3 T_world_camera = cameraPose(CameraMount{}, pan_rad, tilt_rad);
  T_world_camera.translation() = p;
  return T_world_camera;
}

std::vector<Segment3> randomSegments(RandomEngine& engine, int count) {
  std::vector<Segment3> segments;
  const auto point = [&] {
    const double x = uniform(engine, -10, 10);
    const double y = uniform(engine, -10, 10);
    return Eigen::Vector3d(x, y, uniform(engine, 0, 2));
  };
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d a = point();
    segments.push_back({a, i % 3 == 0 ? point() : Eigen::Vector3d(a + Eigen::Vector3d(0.5, 0.2, 0.0))});
  }
  return segments;
}

std::vector<double> exhaustive(const std::vector<Segment3>& segments, const Pose3& T_world_camera,
                               std::span<const Eigen::Vector2d> px) {
  const SegmentProjector projector(camera(), T_world_camera);
  std::vector<double> squares(px.size(), kFar);
  for (const Segment3& segment : segments) {
    const auto line = projector.unbounded(segment);
    if (!line || !projector.isInImage(*line)) continue;
    for (std::size_t i = 0; i < px.size(); ++i) {
      squares[i] = std::min(squares[i], ProjectedLine(*line).square(px[i]));
    }
  }
  return squares;
}

std::vector<Eigen::Vector2d> randomPixels(RandomEngine& engine, int count) {
  std::vector<Eigen::Vector2d> px;
  for (int i = 0; i < count; ++i) {
    const double u = uniform(engine, 0, 319);
    px.emplace_back(u, uniform(engine, 0, 239));
  }
  return px;
}

TEST(ProjectedLine, HandWorkedDistances) {
  const ProjectedLine line(Segment2{{0, 0}, {10, 0}});
  EXPECT_DOUBLE_EQ(line.square({5, 3}), 9.0);
  EXPECT_DOUBLE_EQ(line.square({13, 4}), 25.0) << "beyond an end: 3-4-5";
  EXPECT_DOUBLE_EQ(ProjectedLine(Segment2{{1, 1}, {1, 1}}).square({4, 5}), 25.0) << "a point";
}

TEST(SegmentTreeProperty, GivesTheDistancesOfExhaustiveSearch) {
  RandomEngine engine(3);
  SegmentTree::Buffer buffer;
  int with_lines = 0;
  for (const int count : {0, 1, 30, 500}) {
    const std::vector<Segment3> segments = randomSegments(engine, count);
    const SegmentTree tree(segments);
    for (int i = 0; i < 100; ++i) {
      const double x = uniform(engine, -10, 10);
      const double y = uniform(engine, -10, 10);
      const Pose3 T_world_camera =
          cameraAt({x, y, 1.0}, uniform(engine, -3, 3), degToRad(uniform(engine, -60, 20)));
      const TreeCamera placed(camera(), T_world_camera);
      const auto px = randomPixels(engine, 20);
      const auto expected = exhaustive(segments, T_world_camera, px);
      std::vector<double> squares(px.size());
      const bool is_in_view = tree.nearestSquares(placed, px, squares, buffer);
      EXPECT_EQ(squares, expected) << count << " segments, view " << i;
      EXPECT_EQ(is_in_view, expected.front() < kFar);
      with_lines += is_in_view ? 1 : 0;
      // Bounded: equal below the bound, the bound elsewhere.
      constexpr double kMost = 400.0;
      tree.nearestSquares(placed, px, squares, buffer, kMost);
      for (std::size_t k = 0; k < px.size(); ++k) EXPECT_EQ(squares[k], std::min(kMost, expected[k]));
    }
  }
  EXPECT_GT(with_lines, 100);
}

TEST(SegmentTree, LowersKnownDistancesOnly) {
  RandomEngine engine(4);
  const std::vector<Segment3> segments = randomSegments(engine, 200);
  const SegmentTree tree(segments);
  const Pose3 T_world_camera = cameraAt({0, 0, 1}, 0.4, degToRad(-15));
  const auto px = randomPixels(engine, 50);
  const auto expected = exhaustive(segments, T_world_camera, px);
  std::vector<double> known(px.size());
  for (std::size_t i = 0; i < px.size(); ++i)
    known[i] = i % 2 == 0 ? 0.5 * expected[i] : 2.0 * expected[i] + 1.0;
  std::vector<double> squares = known;
  SegmentTree::Buffer buffer;
  tree.lowerSquares(TreeCamera(camera(), T_world_camera), px, squares, buffer);
  for (std::size_t i = 0; i < px.size(); ++i) EXPECT_EQ(squares[i], std::min(known[i], expected[i])) << i;
}

}  // namespace
}  // namespace vismem
