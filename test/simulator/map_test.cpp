// Maps of worlds: up to date, and at the positions of the rendered edges, with and without lens distortion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"
#include "simulator/core/map_builder.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"
#include "support/build_paths.h"

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
    EXPECT_NEAR(made.segments[i].width_m, map_.segments[i].width_m, 0.002);
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
  const SegmentMap edges = expandStripes(map_, palette_.stripes());
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
  int seen = 0;
  int agree = 0;
  double worst = 0.0;
  std::ostringstream where;
  for (int view = 0; view < 80; ++view) {
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
    const TruthImages truth = renderer.renderTruth(lens, T_world_camera);
    const Eigen::Vector3d eye = T_world_camera.translation();
    for (const MapSegment& segment : edges.segments) {
      const double length = segment.world.length();
      // Near the ends other edges are near.
      for (double s = 0.06; s < length - 0.06; s += 0.2) {
        const Eigen::Vector3d d = (segment.world.b - segment.world.a) / length;
        const Eigen::Vector3d p = segment.world.a + s * d;
        // Nearer than 0.8 m the 2 mm of a door's panel are more than a pixel.
        if ((p - eye).norm() < 0.8 || (p - eye).norm() > 4.0) continue;
        const auto hit = renderer.cast(eye, p - eye);
        if (!hit || std::abs(hit->distance_m - (p - eye).norm()) > 0.03) continue;
        // Nor at junctions of painted lines: there the paint of one covers the edge of the other.
        constexpr double kJunction_m = 0.06;
        const auto lines_here =
            std::count_if(map_.segments.begin(), map_.segments.end(), [&](const auto& row) {
              return row.width_m > 0.0 && distanceToSegment(p, row.world) < 0.5 * row.width_m + kJunction_m;
            });
        if (lines_here > 1) continue;
        const auto here = projectToIdeal(lens, T_world_camera.inverse() * p);
        const auto next = projectToIdeal(lens, T_world_camera.inverse() * (p + 0.02 * d));
        if (!here || !next) continue;
        // The model of a lens says nothing far outside the image: there it folds back.
        const Eigen::Vector2d px = distortPixel(lens, *here);
        if ((undistortPixel(lens, px) - *here).norm() > 0.01) continue;
        const Eigen::Vector2d along = (distortPixel(lens, *next) - px).normalized();
        const Eigen::Vector2d across = turned90(along);
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
        // Two bodies touch here, at this depth, in the true images too.
        const auto bodyAt = [&](const Eigen::Vector2d& at) {
          const cv::Point pixel(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
          return std::pair{truth.model.at<int>(pixel), truth.body.at<int>(pixel)};
        };
        // Far away and flat, the reach may cross a narrow body (a painted line) into the next.
        constexpr double kNear_px = 1.5;
        if (bodyAt(px - kNear_px * across) != bodyAt(px - kReach_px * across) ||
            bodyAt(px + kNear_px * across) != bodyAt(px + kReach_px * across)) {
          continue;
        }
        ++seen;
        const bool two_bodies = bodyAt(px - kReach_px * across) != bodyAt(px + kReach_px * across);
        const double depth = (T_world_camera.inverse() * p).z();
        const double seen_depth = truth.depth_m.at<float>(static_cast<int>(std::lround(px.y())),
                                                          static_cast<int>(std::lround(px.x())));
        // Over one pixel the floor's depth changes by depth^2 / (height * f).
        const double tolerance = 0.03 + 1.5 * depth * depth / (0.45 * lens.fx);
        if (two_bodies && std::abs(seen_depth - depth) < tolerance) ++agree;
        // Position of half of the colour change.
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
        if (std::abs(crossing) > 1.0) {
          ++outside;
          where << "\n"
                << segment.label << " at " << p.transpose() << ", " << crossing << " px off, view " << view
                << ", seen at " << px.transpose() << " from " << (p - eye).norm() << " m";
        }
      }
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
  // A neighbouring edge (a stripe's other side, a leg) may lie within the reach.
  EXPECT_GE(agree, 0.97 * seen) << agree << " of " << seen << " agree with depth and identity";
  EXPECT_GT(compared, 300);
  EXPECT_EQ(outside, 0) << "of " << compared << ", worst " << worst << " px" << where.str();
}

TEST(FieldEdges, AreSplitAtJunctions) {
  // The halfway line, 5 cm wide, joins the inner side of the side line, 6 m long, in its middle; the outer
  // side goes on. As stripes both sides are as long as the line.
  MapBuilderParams as_they_are;
  as_they_are.join_stripes = false;
  const SegmentMap edges = buildSegmentMap(loadWorld(kSource + "/cfg/worlds/field_6x4.world").world,
                                           loadPalette(kSource + "/cfg/maps/field_6x4.palette"), as_they_are);
  const auto between = [&](double x1, double x2, double y) {
    return std::count_if(edges.segments.begin(), edges.segments.end(), [&](const MapSegment& s) {
      const auto [low, high] = std::minmax(s.world.a.x(), s.world.b.x());
      return s.label == "stripe_edge" && s.width_m == 0.0 && std::abs(s.world.a.y() - y) < 0.003 &&
             std::abs(s.world.b.y() - y) < 0.003 && std::abs(low - x1) < 0.003 && std::abs(high - x2) < 0.003;
    });
  };
  EXPECT_EQ(between(-2.975, -0.025, 1.975), 1);
  EXPECT_EQ(between(0.025, 2.975, 1.975), 1);
  EXPECT_EQ(between(-3.025, 3.025, 2.025), 1);
}

TEST(RoomPrimitives, HaveTheirSidesInTheMap) {
  const SegmentMap map = loadSegmentMap(kSource + "/cfg/maps/room.csv");
  std::ifstream stream(kSource + "/cfg/maps/room.primitives.csv");
  ASSERT_TRUE(stream);
  const auto nearMap = [&](const Eigen::Vector2d& p) {
    return std::any_of(map.segments.begin(), map.segments.end(), [&](const MapSegment& s) {
      return s.world.a.z() == 0.0 && s.world.b.z() == 0.0 && distanceToSegment(p, s.world.floor()) < 0.005;
    });
  };
  std::map<std::string, int> kinds;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#' || line.rfind("kind,", 0) == 0) continue;
    std::vector<std::string> fields;
    std::istringstream row(line + ",");
    for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
    ASSERT_EQ(fields.size(), 14U) << line;
    ++kinds[fields[0]];
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 6; i < fields.size() && !fields[i].empty(); i += 2) {
      points.emplace_back(std::stod(fields[i]), std::stod(fields[i + 1]));
    }
    if (fields[0] == "circle") {
      for (const double radius : {std::stod(fields[4]), std::stod(fields[5])}) {
        EXPECT_TRUE(nearMap(points[0] + Eigen::Vector2d(0, radius * std::cos(std::numbers::pi / 48))))
            << line;
      }
    } else if (fields[0] == "arrow") {
      const double half = 0.5 * std::stod(fields[3]);
      EXPECT_TRUE(nearMap(0.5 * (points[0] + points[1]) + Eigen::Vector2d(0, half))) << line;
      EXPECT_LT((points[2] - points[1]).norm() - (points[3] - points[1]).norm(), 0.001) << line;
    } else {
      ASSERT_EQ(points.size(), fields[0] == "triangle" ? 3U : 4U) << line;
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_TRUE(nearMap(0.5 * (points[i] + points[(i + 1) % points.size()]))) << line << " side " << i;
      }
    }
  }
  EXPECT_EQ(kinds,
            (std::map<std::string, int>{{"arrow", 1}, {"circle", 1}, {"parallelogram", 7}, {"triangle", 1}}));
}

INSTANTIATE_TEST_SUITE_P(OwnWorlds, WorldMap,
                         testing::Values("corridor", "corridor_irregular", "room", "curve", "field_6x4",
                                         "field_9x6", "texture", "furniture", "alike_wings"),
                         [](const auto& world) { return std::string(world.param); });

}  // namespace
}  // namespace vismem
