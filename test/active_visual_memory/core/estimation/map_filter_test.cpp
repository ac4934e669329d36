// Tests M6.
#include "active_visual_memory/core/estimation/map_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "common/kinematics/kinematics.h"

namespace vismem {
namespace {

CameraMount mount() {
  CameraMount m;
  m.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  return m;
}

TEST(MapFilter, HeadingNoiseGrowsByTurnNoise) {
  // Of a robot that drives a metre: a line ahead of it, seen before, is as far off as the heading.
  const auto after = [](double turn_noise) {
    MapFilter filter{TiltPrior{}};
    MapFilter::Params params;
    params.turn_noise = turn_noise;
    params.drift.turn_per_rad = params.drift.turn_per_m = params.drift.shift_per_m = 0.0;
    FloorSegment seen;
    seen.odom = {{2.0, 0.0}, {3.0, 0.0}};
    seen.P_a = seen.P_b = 1e-6 * Eigen::Matrix2d::Identity();
    filter.update({0.0, 0.0}, {}, std::nullopt, {}, params);
    filter.addLine(1, seen, {cameraPose(mount(), 0.0, -0.3), 0.0}, 1.0, 0.0);
    const double before = filter.placeVariance(1, Eigen::Vector2d::UnitY(), {2.0, 0.0});
    filter.predict({}, {1.0, 0.0, 0.0}, params);
    filter.update({1.0, 0.0}, {}, std::nullopt, {}, params);
    return filter.placeVariance(1, Eigen::Vector2d::UnitY(), {2.0, 0.0}) - before;
  };
  EXPECT_NEAR(after(0.05) - after(0.0), 0.05 * 0.05, 1e-9);
}

TEST(MapFilter, AddsCopiesReplacesAndRemovesLines) {
  MapFilter filter{TiltPrior{}};
  const TiltView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  FloorSegment seen;
  seen.odom = {{1.0, -0.5}, {1.0, 0.5}};
  seen.P_a = seen.P_b = 1e-4 * Eigen::Matrix2d::Identity();
  filter.update({0.0, 0.0}, {}, std::nullopt, {}, {});
  filter.addLine(7, seen, view, 1.0, 0.0);
  filter.copyLine(8, 7);
  EXPECT_TRUE(filter.contains(7) && filter.contains(8) && !filter.contains(9));
  const double known = filter.placeVariance(7, Eigen::Vector2d::UnitX(), {1.0, 0.0});
  EXPECT_GT(known, 0.0);
  EXPECT_DOUBLE_EQ(filter.placeVariance(8, Eigen::Vector2d::UnitX(), {1.0, 0.0}), known);
  filter.replaceLine(8, 9);
  filter.removeLine(7);
  EXPECT_TRUE(!filter.contains(7) && !filter.contains(8) && filter.contains(9));
  EXPECT_DOUBLE_EQ(filter.placeVariance(9, Eigen::Vector2d::UnitX(), {1.0, 0.0}), known);
  for (std::uint64_t id = 100; id < 100 + 2 * MapFilter::kMaxLines; ++id)
    filter.addLine(id, seen, view, 1.0, 0.0);
  EXPECT_TRUE(filter.contains(99 + 2 * MapFilter::kMaxLines)) << "the one unseen for longest gives way";
  filter.reset();
  EXPECT_FALSE(filter.contains(99 + 2 * MapFilter::kMaxLines));
}

/// A line that lies across the view.
FloorSegment across(double x, double slope) {
  FloorSegment seen;
  seen.odom = {{x, -0.5}, {x + slope, 0.5}};
  seen.P_a = seen.P_b = 1e-4 * x * Eigen::Matrix2d::Identity();
  return seen;
}

TEST(MapFilter, RemovingALineKeepsTheOthersBits) {
  MapFilter filter{TiltPrior{}};
  const TiltView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  filter.update({0.0, 0.0}, {}, std::nullopt, {}, {});
  for (int id = 1; id <= 5; ++id) {
    filter.addLine(static_cast<std::uint64_t>(id), across(0.5 + 0.3 * id, 0.1 * id), view, 1.0, 0.0);
  }
  const auto variance = [&](std::uint64_t id) {
    return filter.placeVariance(id, Eigen::Vector2d{1.0, -0.2}.normalized(), {1.5, 0.4});
  };
  const double first = variance(1);
  const double fourth = variance(4);
  const double last = variance(5);
  EXPECT_NE(first, fourth);
  filter.removeLine(2);
  filter.retainIf([](std::uint64_t id) { return id != 3; });
  EXPECT_EQ(variance(1), first);
  EXPECT_EQ(variance(4), fourth);
  EXPECT_EQ(variance(5), last);
  filter.removeLine(5);
  EXPECT_EQ(variance(4), fourth);
  EXPECT_EQ(variance(5), 0.0) << "it is unknown";
}

TEST(MapFilter, PreviewReturnsWhatUpdateWillAndChangesNothing) {
  MapFilter filter{TiltPrior{}};
  const TiltView view(cameraPose(mount(), 0.0, -0.3), 0.0);
  const MapFilter::Params params;
  filter.update({0.0, 0.0}, {}, std::nullopt, {}, params);
  filter.addLine(1, across(1.0, 0.0), view, 1.0, 0.0);
  filter.addLine(2, across(2.0, 0.1), view, 1.0, 0.0);
  filter.predict({}, {0.1, 0.0, 0.2}, params);
  const Eigen::Vector2d robot{0.1, 0.0};
  std::vector<LineResidual> residuals(2);
  residuals[0].line = 1;
  residuals[1].line = 2;
  for (LineResidual& residual : residuals) {
    residual.common.p = {1.0, 0.3};
    residual.common.residual_m = 0.01;
    residual.common.variance_m2 = 1e-4;
    residual.common.d_tilt = {0.1, 1.0, 0.2, 0.9};
    residual.common.d_frame_tilt = {0.1, 1.0};
  }
  const std::vector<LineDirection> directions{{1, 1.55}};
  const double before = filter.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3});
  const auto previewed = filter.preview(robot, residuals, 0.01, directions, params);
  ASSERT_TRUE(previewed);
  EXPECT_GT(previewed->motion.shift.norm(), 1e-4);
  EXPECT_EQ(filter.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3}), before);
  EXPECT_FALSE(filter.dominantDirection());
  EXPECT_EQ(filter.cameraTilt(), CameraTilt::Zero());
  const auto updated = filter.update(robot, residuals, 0.01, directions, params);
  ASSERT_TRUE(updated);
  EXPECT_EQ(previewed->motion.shift, updated->motion.shift);
  EXPECT_EQ(previewed->motion.turn_rad, updated->motion.turn_rad);
  EXPECT_EQ(previewed->camera_tilt, updated->camera_tilt);
  EXPECT_EQ(previewed->frame_tilt, updated->frame_tilt);
  EXPECT_EQ(previewed->P_frame_tilt, updated->P_frame_tilt);
  EXPECT_LT(filter.placeVariance(1, Eigen::Vector2d::UnitX(), {1.0, 0.3}), before);
  EXPECT_TRUE(filter.dominantDirection());
}

}  // namespace
}  // namespace vismem
