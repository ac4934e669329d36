// Maps made from worlds: up to date, and where the rendered edges are, with and without a distorting lens.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "simulator/core/map_builder.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"

namespace vismem {
namespace {

const std::string kSource = VISMEM_SOURCE_DIR;

class WorldMap : public testing::TestWithParam<const char*> {
 protected:
  const std::string name_ = GetParam();
  const World world_ = loadWorld(kSource + "/cfg/worlds/" + name_ + ".world").world;
  const Palette palette_ = loadPalette(kSource + "/cfg/maps/" + name_ + ".palette");
  const SegmentMap map_ = loadSegmentMap(kSource + "/cfg/maps/" + name_ + ".csv");
};

TEST_P(WorldMap, LoadsWithoutWarningsAndTheCommittedMapIsWhatMakeMapWrites) {
  EXPECT_TRUE(loadWorld(kSource + "/cfg/worlds/" + name_ + ".world").warnings.empty());
  const SegmentMap made = buildSegmentMap(world_, palette_);
  ASSERT_EQ(made.segments.size(), map_.segments.size()) << "run make_map again";
  for (std::size_t i = 0; i < made.segments.size(); ++i) {
    EXPECT_EQ(made.segments[i].label, map_.segments[i].label);
    // Another processor may round a bisection differently.
    EXPECT_LT((made.segments[i].world.a - map_.segments[i].world.a).norm(), 0.003);
    EXPECT_LT((made.segments[i].world.b - map_.segments[i].world.b).norm(), 0.003);
  }
}

Eigen::Vector3d colorAt(const cv::Mat& image, const Eigen::Vector2d& px) {
  const int u = static_cast<int>(std::floor(px.x()));
  const int v = static_cast<int>(std::floor(px.y()));
  const double fu = px.x() - u;
  const double fv = px.y() - v;
  const auto at = [&](int x, int y) {
    const std::uint8_t* p = image.ptr<std::uint8_t>(y) + 3 * x;
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  return (1 - fv) * ((1 - fu) * at(u, v) + fu * at(u + 1, v)) +
         fv * ((1 - fu) * at(u, v + 1) + fu * at(u + 1, v + 1));
}

TEST_P(WorldMap, LiesOnRenderedEdgesWithinOnePixel) {
  Renderer renderer(world_);
  const SimulationConfig robot;
  const SimulatedBase base(robot.base, {}, obstaclesOf(world_));
  std::mt19937_64 engine(20);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  const Eigen::Vector2d low = map_.low();
  const Eigen::Vector2d high = map_.high();
  int compared = 0;
  int outside = 0;
  double worst = 0.0;
  for (int view = 0; view < 60; ++view) {
    CameraIntrinsics lens = robot.cameras.front().intrinsics;
    if (view % 2 == 1) {
      lens.k1 = -0.25;
      lens.k2 = 0.06;
      lens.p1 = 0.002;
      lens.p2 = -0.001;
    }
    Pose2 pose;
    do {
      pose = {uniform(low.x(), high.x()), uniform(low.y(), high.y()), uniform(-3.1, 3.1)};
    } while (base.collidesAt(pose));
    const Pose3 T_world_camera =
        toPose3(pose) * cameraPose(robot.mount(), uniform(-1.0, 1.0), uniform(-0.5, 0.1));
    const cv::Mat image = renderer.render(lens, T_world_camera);
    const Eigen::Vector3d eye = T_world_camera.translation();
    for (const MapSegment& segment : map_.segments) {
      const double length = segment.world.length();
      // Near the ends other edges are near.
      for (double s = 0.06; s < length - 0.06; s += 0.2) {
        const Eigen::Vector3d d = (segment.world.b - segment.world.a) / length;
        const Eigen::Vector3d p = segment.world.a + s * d;
        // Nearer than 0.8 m the 2 mm of a door's panel are more than a pixel.
        if ((p - eye).norm() < 0.8 || (p - eye).norm() > 4.0) continue;
        const auto hit = renderer.cast(eye, p - eye);
        if (!hit || std::abs(hit->distance_m - (p - eye).norm()) > 0.03) continue;
        const auto here = projectToIdeal(lens, T_world_camera.inverse() * p);
        const auto next = projectToIdeal(lens, T_world_camera.inverse() * (p + 0.02 * d));
        if (!here || !next) continue;
        // The model of a lens says nothing far outside the image: there it folds back.
        const Eigen::Vector2d px = distortPixel(lens, *here);
        if ((undistortPixel(lens, px) - *here).norm() > 0.01) continue;
        const Eigen::Vector2d along = (distortPixel(lens, *next) - px).normalized();
        const Eigen::Vector2d across(-along.y(), along.x());
        constexpr double kReach_px = 4.0;
        if (px.minCoeff() < kReach_px + 1 || px.x() > lens.width - kReach_px - 2 ||
            px.y() > lens.height - kReach_px - 2) {
          continue;
        }
        const Eigen::Vector3d from = colorAt(image, px - kReach_px * across);
        const Eigen::Vector3d to = colorAt(image, px + kReach_px * across);
        const auto classOf = [&](const Eigen::Vector3d& c) {
          return palette_.classOf(static_cast<std::uint8_t>(c.x()), static_cast<std::uint8_t>(c.y()),
                                  static_cast<std::uint8_t>(c.z()));
        };
        if (palette_.label(classOf(from), classOf(to)) != segment.label) continue;
        // Where the colour has gone half the way.
        double crossing = kReach_px;
        int crossings = 0;
        bool before = false;
        for (double t = -kReach_px; t <= kReach_px; t += 0.05) {
          const Eigen::Vector3d c = colorAt(image, px + t * across);
          const bool after = (c - from).dot(to - from) > 0.5 * (to - from).squaredNorm();
          if (after != before) {
            ++crossings;
            crossing = t;
          }
          before = after;
        }
        // A third colour in between (a stripe's other edge, a door's end) leaves no single place.
        if (crossings != 1) continue;
        ++compared;
        worst = std::max(worst, std::abs(crossing));
        if (std::abs(crossing) > 1.0) ++outside;
      }
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_GT(compared, 300);
  EXPECT_EQ(outside, 0) << "of " << compared << ", worst " << worst << " px";
}

INSTANTIATE_TEST_SUITE_P(OwnWorlds, WorldMap, testing::Values("corridor", "room"),
                         [](const auto& world) { return std::string(world.param); });

}  // namespace
}  // namespace vismem
