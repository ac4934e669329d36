// Tests M6, M7.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "active_visual_memory/core/estimation/map_filter.h"
#include "common/kinematics/kinematics.h"
#include "support/allocations.h"

namespace vismem {
namespace {

TEST(MapFilter, TheCountHasWhatEigenAndTheLibraryAllocate) {
  volatile int size = 10;
  const long before = test::allocations();
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(size, size);
  const std::vector<double> list(static_cast<std::size_t>(size), matrix(1, 2));
  EXPECT_EQ(test::allocations() - before, 2) << matrix.sum() << list.back();
}

/// Residuals of one image against the lines `first` to `first + lines - 1`.
struct Image {
  Image(std::uint64_t first, int lines, int residuals_, std::mt19937_64& random) {
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int i = 0; i < residuals_; ++i) {
      LineResidual residual;
      residual.line = first + random() % static_cast<std::uint64_t>(lines);
      const double direction = noise(random);
      residual.p = {1.0 + noise(random), noise(random)};
      residual.direction = {std::cos(direction), std::sin(direction)};
      residual.residual_m = 0.02 * noise(random);
      residual.variance_m2 = 1e-4;
      residual.d_tilt = {noise(random), noise(random), noise(random), noise(random)};
      residual.d_frame_tilt = residual.d_tilt.head<2>();
      residuals.push_back(residual);
    }
    for (int i = 0; i < lines; ++i) directions.push_back({first + static_cast<std::uint64_t>(i), 0.01});
  }
  std::vector<LineResidual> residuals;
  std::vector<LineDirection> directions;
};

TEST(MapFilter, AllocatesNothingAfterItsConstruction) {
  std::mt19937_64 random(1);
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.45, 0, 0, 0);
  const TiltView view(cameraPose(mount, 0.0, -0.3), 0.0);
  const MapFilter::Params params;
  FloorSegment seen;
  seen.a.P = seen.b.P = 1e-4 * Eigen::Matrix2d::Identity();
  MapFilter filter{TiltPrior{}};
  std::uint64_t next = 1;
  std::size_t most = 0;
  Pose2 pose;
  // From nothing to more lines and residuals than it takes.
  for (int i = 1; i <= 40; ++i) {
    const int lines = 4 * i;
    const std::uint64_t first = next > static_cast<std::uint64_t>(lines) ? next - lines : 1;
    const Image image(first, lines, 4 * i, random);
    const long before = test::allocations();
    const Pose2 now = pose * Pose2{0.02, 0.0, 0.1};
    filter.predict(pose, now, params);
    pose = now;
    const auto previewed = filter.preview({pose.position(), image.residuals, 0.01, image.directions}, params);
    const auto solved = filter.update({pose.position(), image.residuals, 0.01, image.directions}, params);
    for (int k = 0; k < 6; ++k) {
      seen.place({{1.0 + 0.1 * k, -0.5}, {1.0, 0.5 + 0.01 * i}});
      filter.addLine(next++, seen, view, 1.0, 0.0);
    }
    filter.copyLine(next, next - 1);
    filter.replaceLine(next, next + 1);
    filter.removeLine(next - 2);
    filter.retainIf([&](std::uint64_t id) { return id + 1 != next; });
    const double variance = filter.placeVariance(next - 3, Eigen::Vector2d::UnitX(), {1.0, 0.0});
    EXPECT_EQ(test::allocations() - before, 0) << i;
    EXPECT_TRUE(previewed && solved && variance > 0.0) << i;
    next += 2;
    most = std::max(most, filter.lineCorrections().size());
  }
  EXPECT_GE(most, MapFilter::kMaxLines - 2U);
  filter.reset();
  const long before = test::allocations();
  EXPECT_FALSE(filter.preview({{0.0, 0.0}, {}, std::nullopt, {}}, params));
  EXPECT_EQ(test::allocations() - before, 0);
}

}  // namespace
}  // namespace vismem
