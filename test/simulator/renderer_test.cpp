// Images of moving worlds, their ground truth, and their independence of threads and packets.
#include "simulator/core/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "common/geometry/angles.h"
#include "simulator/core/shapes.h"

namespace vismem {
namespace {

WorldModel boxModel(const std::string& name, const Eigen::Vector3d& size, const Pose3& pose,
                    const Eigen::Vector3f& color) {
  const TriangleMesh mesh = boxMesh(size);
  WorldBody body;
  body.name = "link/visual";
  body.color = color;
  body.vertices = mesh.vertices;
  body.triangles = mesh.triangles;
  WorldModel model;
  model.name = name;
  model.pose = pose;
  model.bodies.push_back(std::move(body));
  return model;
}

Pose3 at(double x, double y, double z, double yaw = 0.0) {
  return poseFromXyzRpy(x, y, z, 0, 0, yaw);
}

/// A floor and two boxes.
World smallWorld() {
  World world;
  world.models.push_back(boxModel("floor", {20, 20, 0.1}, at(0, 0, -0.05), {0.4f, 0.4f, 0.4f}));
  world.models.push_back(boxModel("red", {1, 1, 1}, at(3, 0.8, 0.5), {0.8f, 0.1f, 0.1f}));
  world.models.push_back(boxModel("blue", {1, 1, 1}, at(4, -0.8, 0.5), {0.1f, 0.1f, 0.8f}));
  world.lights.emplace_back();
  return world;
}

CameraIntrinsics smallCamera() {
  return intrinsicsFromFieldOfView(160, 120, degToRad(60.0));
}
/// At 0.5 m, looking along x.
Pose3 eye() {
  return at(0, 0, 0.5) * cameraPose({}, 0.0, 0.0);
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(Renderer, AMovedModelLooksAsIfItHadAlwaysStoodThere) {
  World moved = smallWorld();
  Renderer renderer(moved);
  const cv::Mat before = renderer.render(smallCamera(), eye());
  const Pose3 elsewhere = at(2.5, -0.3, 0.7, 0.4);
  renderer.setModelPose(1, elsewhere);
  moved.models[1].pose = elsewhere;
  Renderer fixed(moved);
  const cv::Mat image = renderer.render(smallCamera(), eye());
  EXPECT_FALSE(same(image, before));
  // Another tree rounds differently: single grey levels on edges.
  EXPECT_LE(cv::norm(image, fixed.render(smallCamera(), eye()), cv::NORM_INF), 2.0);
  renderer.setModelPose(1, smallWorld().models[1].pose);
  EXPECT_LE(cv::norm(renderer.render(smallCamera(), eye()), before, cv::NORM_INF), 2.0);
}

TEST(Renderer, NormalsOfATurnedModelTurnWithIt) {
  World world = smallWorld();
  Renderer renderer(world);
  renderer.setModelPose(1, at(3, 0, 0.5, degToRad(30.0)));
  // The face that looks at -x now looks at 210 degrees.
  const auto hit = renderer.cast({0, 0, 0.5}, {1, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->model, 1);
  EXPECT_NEAR(hit->normal.x(), std::cos(degToRad(210.0)), 1e-5);
  EXPECT_NEAR(hit->normal.y(), std::sin(degToRad(210.0)), 1e-5);
}

TEST(Renderer, AHiddenModelIsNeitherSeenNorThrowsAShadow) {
  World without = smallWorld();
  without.models.pop_back();
  Renderer expected(without);
  for (const bool move_first : {false, true}) {
    World world = smallWorld();
    Renderer renderer(world);
    const cv::Mat all = renderer.render(smallCamera(), eye());
    if (move_first) renderer.setModelPose(2, at(4, -0.81, 0.5));
    renderer.setModelVisible(2, false);
    EXPECT_TRUE(same(renderer.render(smallCamera(), eye()), expected.render(smallCamera(), eye())));
    if (move_first) renderer.setModelPose(2, world.models[2].pose);
    renderer.setModelVisible(2, true);
    EXPECT_LE(cv::norm(renderer.render(smallCamera(), eye()), all, cv::NORM_INF), 2.0);
  }
}

TEST(Renderer, ModelsCanBeAddedAndAllCanBeHidden) {
  World world = smallWorld();
  Renderer renderer(world);
  const int added = renderer.addModel(boxModel("new", {0.2, 0.2, 0.2}, at(1, 0, 0.5), {0, 1, 0}));
  EXPECT_EQ(added, 3);
  EXPECT_EQ(renderer.modelCount(), 4);
  const auto hit = renderer.cast({0, 0, 0.5}, {1, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->model, added);
  EXPECT_NEAR(hit->distance_m, 0.9, 1e-5);
  for (int i = 0; i < renderer.modelCount(); ++i) renderer.setModelVisible(i, false);
  EXPECT_FALSE(renderer.cast({0, 0, 0.5}, {1, 0, 0}));
  EXPECT_FALSE(renderer.cast({0, 0, 0.5}, {0, 0, -1}));
}

TEST(Renderer, RefusesPosesThatAreNotFiniteAndModelsThatAreNotThere) {
  World world = smallWorld();
  Renderer renderer(world);
  Pose3 bad = Pose3::Identity();
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(renderer.setModelPose(0, bad), std::invalid_argument);
  EXPECT_THROW(renderer.setModelPose(3, Pose3::Identity()), std::out_of_range);
  EXPECT_THROW(renderer.setModelVisible(-1, false), std::out_of_range);
  EXPECT_THROW(renderer.render(smallCamera(), bad), std::invalid_argument);
  CameraIntrinsics nothing = smallCamera();
  nothing.width = 0;
  EXPECT_THROW(renderer.render(nothing, eye()), std::invalid_argument);
  EXPECT_THROW(renderer.renderTruth(nothing, eye()), std::invalid_argument);
}

TEST(Renderer, TruthIsTheDepthAlongTheAxisAndWhoIsThere) {
  World world = smallWorld();
  Renderer renderer(world);
  CameraIntrinsics lens = smallCamera();
  lens.k1 = -0.2;
  for (const bool moved : {false, true}) {
    if (moved) renderer.setModelPose(1, at(3.2, 0.7, 0.5));
    const double front_m = moved ? 2.7 : 2.5;
    const TruthImages truth = renderer.renderTruth(lens, eye());
    int different = 0;
    for (int v = 0; v < lens.height; ++v) {
      for (int u = 0; u < lens.width; ++u) {
        const Eigen::Vector3d ray = idealPixelRay(lens, undistortPixel(lens, Eigen::Vector2d(u, v)));
        const Eigen::Vector3d d = eye().linear() * ray;
        const auto hit = renderer.cast(eye().translation(), d);
        const int model = truth.model.at<int>(v, u);
        if (model != (hit ? hit->model : TruthImages::kNothing)) {
          ++different;  // a ray along an edge, rounded to the other side
          continue;
        }
        if (!hit) {
          EXPECT_TRUE(std::isinf(truth.depth_m.at<float>(v, u)));
          EXPECT_EQ(truth.body.at<int>(v, u), TruthImages::kNothing);
          continue;
        }
        EXPECT_NEAR(truth.depth_m.at<float>(v, u), hit->distance_m / ray.norm(), 1e-3);
        // The red box's front is a plane across the axis: one depth.
        if (model == 1 && hit->normal.x() < -0.99) {
          EXPECT_NEAR(truth.depth_m.at<float>(v, u), front_m, 1e-4);
        }
      }
    }
    EXPECT_LE(different, 5);
  }
}

TEST(Renderer, CamerasOfDifferentSizeTakeTurns) {
  World world = smallWorld();
  Renderer renderer(world);
  CameraIntrinsics wide = intrinsicsFromFieldOfView(333, 101, degToRad(90.0));
  wide.k1 = -0.1;
  const cv::Mat first = renderer.render(smallCamera(), eye());
  const cv::Mat second = renderer.render(wide, eye());
  EXPECT_EQ(second.size(), cv::Size(333, 101));
  EXPECT_TRUE(same(renderer.render(smallCamera(), eye()), first));
  EXPECT_TRUE(same(renderer.render(wide, eye()), second));
  // More cameras than are remembered.
  for (int i = 0; i < 12; ++i) {
    const auto k = intrinsicsFromFieldOfView(16 + i, 16, degToRad(60.0));
    EXPECT_EQ(renderer.render(k, eye()).cols, 16 + i);
  }
  EXPECT_TRUE(same(renderer.render(smallCamera(), eye()), first));
}

TEST(Renderer, ThreadsDoNotShowInTheImage) {
  World world = smallWorld();
  RendererOptions two;
  two.parallel_for = [](int count, const std::function<void(int)>& task) {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 2; ++t) {
      threads.emplace_back([=, &task] {
        for (int i = t; i < count; i += 2) task(i);
      });
    }
  };
  Renderer alone(world);
  Renderer together(world, two);
  for (const int moved : {0, 1}) {
    if (moved == 1) {
      alone.setModelPose(1, at(2, 0.1, 0.5, 0.3));
      together.setModelPose(1, at(2, 0.1, 0.5, 0.3));
    }
    EXPECT_TRUE(same(alone.render(smallCamera(), eye()), together.render(smallCamera(), eye())));
    EXPECT_TRUE(same(alone.renderTruth(smallCamera(), eye()).depth_m,
                     together.renderTruth(smallCamera(), eye()).depth_m));
  }
}

TEST(Renderer, EdgesAreSmoothWhereverPacketsEnd) {
  // A dark wall whose upper edge rises by one pixel in forty, before the sky. Where the edge passes from one
  // row of packets to the next, pixels of mixed colour must be as frequent as elsewhere.
  World world;
  Pose3 wall = poseFromXyzRpy(5, 0, -5, std::atan(1.0 / 40.0), 0, 0);
  world.models.push_back(boxModel("wall", {0.1, 40, 10}, wall, {0.1f, 0.1f, 0.1f}));
  world.lights.emplace_back();
  Renderer renderer(world);
  const CameraIntrinsics k = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  const cv::Mat image = renderer.render(k, at(0, 0, 0) * cameraPose({}, 0.0, 0.0));
  const int sky = image.at<cv::Vec3b>(0, 160)[0];
  const int dark = image.at<cv::Vec3b>(239, 160)[0];
  for (int u = 0; u < k.width; ++u) {
    // The edge's place by the brightness of its column, against the true one by geometry.
    double bright_rows = 0.0;
    for (int v = 0; v < k.height; ++v) {
      bright_rows += (image.at<cv::Vec3b>(v, u)[0] - dark) / static_cast<double>(sky - dark);
    }
    // Top of the wall's near face through (4.95, y, z): z = 5 cos - 5 + (y + 5 sin) tan, seen at v - cy = -f
    // z / x.
    const double slope = 1.0 / 40.0;
    const double angle = std::atan(slope);
    const double y_over_x = -(u - k.cx) / k.fx;
    const double z_at_0 = 5.0 * std::cos(angle) - 5.0 + 5.0 * std::sin(angle) * slope;
    const double edge_v = k.cy - k.fy * (z_at_0 / 4.95 + slope * y_over_x);
    // Rows 0..edge are sky: edge + 0.5 of them. Four samples a pixel resolve a quarter.
    EXPECT_NEAR(bright_rows, edge_v + 0.5, 0.3) << "column " << u;
  }
}

TEST(Renderer, LinesThinnerThanAPixelDoNotComeOutDashed) {
  // A painted stripe of 5 cm, 6 m away, a little aslant: 0.05 * 0.5 / 6^2 * f = 0.19 pixels high with f =
  // 277.
  World world;
  world.models.push_back(boxModel("floor", {60, 60, 0.1}, at(0, 0, -0.05), {0.1f, 0.1f, 0.1f}));
  world.models.push_back(boxModel("stripe", {0.05, 14, 0.002}, at(6, 0, 0.001, 0.15), {1, 1, 1}));
  world.ambient = {1, 1, 1};
  world.lights.emplace_back();
  world.lights.back().color.setZero();
  for (const double k1 : {0.0, -0.25}) {
    Renderer renderer(world);
    CameraIntrinsics lens = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
    lens.k1 = k1;
    double sum = 0;
    int dark = 0;
    int longest = 0;
    for (const bool moved : {false, true}) {
      // Moved, the stripe is where it was in another pixel row.
      if (moved) renderer.setModelPose(1, at(5.9, 0, 0.001, 0.15));
      const cv::Mat image = renderer.render(lens, eye());
      const double floor = image.at<cv::Vec3b>(200, 160)[0];
      for (int u = 20; u < 300; ++u) {
        double covered = 0;
        for (int v = 125; v < 170; ++v) {
          covered += (image.at<cv::Vec3b>(v, u)[0] - floor) / (255 - floor);
        }
        sum += covered;
        dark = covered < 0.1 ? dark + 1 : 0;
        longest = std::max(longest, dark);
      }
    }
    EXPECT_NEAR(sum / 560, 0.28, 0.03) << "k1 = " << k1;
    EXPECT_LE(longest, 6) << "columns without a trace of the stripe, k1 = " << k1;
  }
}

}  // namespace
}  // namespace vismem
