// Tests L4.
#include "localization/core/likelihood/pixel_footprint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "localization/core/random_engine.h"

namespace vismem {
namespace {

struct Camera {
  CameraIntrinsics intrinsics;
  Pose3 T_robot_camera;
};

/// Of any height, tilt and roll; some look up.
Camera randomCamera(RandomEngine& engine) {
  Camera camera;
  camera.intrinsics = intrinsicsFromFieldOfView(320, 240, uniform(engine, 0.5, 1.8));
  camera.intrinsics.cx += uniform(engine, -20, 20);
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(uniform(engine, -0.2, 0.2), uniform(engine, -0.2, 0.2),
                                         uniform(engine, 0.1, 1.8), uniform(engine, -0.3, 0.3), 0, 0);
  camera.T_robot_camera = cameraPose(mount, uniform(engine, -3, 3), uniform(engine, -1.5, 0.3));
  return camera;
}

Eigen::Vector2d randomPixel(RandomEngine& engine) {
  return {uniform(engine, 0, 319), uniform(engine, 0, 239)};
}

/// What a point of the floor before the camera shows as.
std::optional<Eigen::Vector2d> pixelOf(const Camera& camera, const Eigen::Vector2d& p_robot) {
  const Eigen::Vector3d p(p_robot.x(), p_robot.y(), 0.0);
  return projectToIdeal(camera.intrinsics, camera.T_robot_camera.inverse() * p);
}

TEST(PixelFootprintProperty, EqualsBackProjection) {
  RandomEngine engine(1);
  int on_floor = 0;
  for (int i = 0; i < 1000; ++i) {
    const Camera camera = randomCamera(engine);
    const Eigen::Vector2d px = randomPixel(engine);
    const PixelFootprint footprint(camera.intrinsics, camera.T_robot_camera, px);
    const auto floor = backProjectToGround(camera.intrinsics, camera.T_robot_camera, px, 1e4);
    if (!floor) continue;
    ++on_floor;
    ASSERT_TRUE(footprint.isOnFloor());
    EXPECT_LT((footprint.p_robot() - floor->head<2>()).norm(), 1e-6 * (1.0 + floor->norm()));
  }
  EXPECT_GT(on_floor, 500);
}

TEST(PixelFootprintProperty, ReachBoundsTheImageDistanceFromBelow) {
  RandomEngine engine(2);
  int bounded = 0;
  int shown = 0;
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = randomCamera(engine);
    const Eigen::Vector2d px = randomPixel(engine);
    const PixelFootprint footprint(camera.intrinsics, camera.T_robot_camera, px);
    for (int k = 0; k < 50; ++k) {
      const double angle = uniform(engine, -3.2, 3.2);
      const double distance_m = std::pow(10.0, uniform(engine, -2, 3));
      const Eigen::Vector2d p =
          footprint.p_robot() + distance_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const auto other = pixelOf(camera, p);
      if (!other) continue;
      ++shown;
      const double reach_px = footprint.reach(distance_m);
      const double distance_px = (*other - px).norm();
      ASSERT_GE(distance_px, reach_px * (1.0 - 1e-9) - 1e-9) << "camera " << i << ", " << distance_m << " m";
      bounded += reach_px > 1.0 ? 1 : 0;
      const double within_px = uniform(engine, 0, 100);
      if (distance_px < within_px * (1.0 - 1e-9) && footprint.isOnFloor()) {
        ASSERT_LE(distance_m, footprint.radius(within_px) * (1.0 + 1e-9));
      }
    }
  }
  EXPECT_GT(shown, 20'000);
  EXPECT_GT(bounded, 10'000);
}

TEST(PixelFootprint, TheBoundIsReachedTowardsTheHorizon) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.5, 0, 0, 0);
  const Camera camera{intrinsicsFromFieldOfView(320, 240, degToRad(60)),
                      cameraPose(mount, 0.0, degToRad(-20))};
  const Eigen::Vector2d px(camera.intrinsics.cx, 150.0);
  const PixelFootprint footprint(camera.intrinsics, camera.T_robot_camera, px);
  for (const double distance_m : {0.1, 0.5, 2.0, 10.0}) {
    const auto beyond = pixelOf(camera, footprint.p_robot() + Eigen::Vector2d(distance_m, 0.0));
    ASSERT_TRUE(beyond);
    EXPECT_NEAR((*beyond - px).norm(), footprint.reach(distance_m), 0.01 * footprint.reach(distance_m));
  }
}

TEST(PixelFootprint, HasNoBoundsAboveTheHorizonOrOnTheFloor) {
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, 0.5, 0, 0, 0);
  const CameraIntrinsics k = intrinsicsFromFieldOfView(320, 240, degToRad(60));
  const PixelFootprint sky(k, cameraPose(mount, 0.0, 0.0), {160, 20});
  mount.T_robot_pantilt = poseFromXyzRpy(0, 0, -0.1, 0, 0, 0);
  const PixelFootprint buried(k, cameraPose(mount, 0.0, degToRad(-30)), {160, 120});
  for (const PixelFootprint& one : {sky, buried}) {
    EXPECT_FALSE(one.isOnFloor());
    EXPECT_EQ(one.reach(5.0), 0.0);
    EXPECT_TRUE(std::isinf(one.radius(1.0)));
  }
}

TEST(FloorWithinProperty, ContainsAllFloorNearThePixels) {
  RandomEngine engine(3);
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const Camera camera = randomCamera(engine);
    std::vector<Eigen::Vector2d> pixels;
    std::vector<PixelFootprint> footprints;
    for (int k = 0; k < 10; ++k) {
      pixels.push_back(randomPixel(engine));
      footprints.emplace_back(camera.intrinsics, camera.T_robot_camera, pixels.back());
    }
    const double within_px = uniform(engine, 1, 60);
    const double most_m = uniform(engine, 0.2, 4);
    const FloorDisc disc = floorWithin(footprints, within_px, most_m);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      if (footprints[k].radius(within_px) > most_m) continue;
      const double angle = uniform(engine, -3.2, 3.2);
      const Eigen::Vector2d near =
          pixels[k] + 0.999 * within_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const auto floor = backProjectToGround(camera.intrinsics, camera.T_robot_camera, near, 1e6);
      ASSERT_TRUE(floor) << "the horizon is further";
      EXPECT_LE((floor->head<2>() - disc.middle).norm(), disc.radius_m + 1e-9);
      ++inside;
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_EQ(floorWithin({}, 10.0, 1.0).radius_m, 0.0);
}

}  // namespace
}  // namespace vismem
