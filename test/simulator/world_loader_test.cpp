#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/config/config_error.h"
#include "simulator/core/shapes.h"
#include "simulator/core/world.h"

namespace vismem {
namespace {

using testing::Contains;
using testing::HasSubstr;

class WorldLoader : public testing::Test {
 protected:
  WorldLoader()
      : folder_(std::filesystem::path(testing::TempDir()) / ("world_loader_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~WorldLoader() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& text) {
    const auto path = (folder_ / "test.world").string();
    std::ofstream(path) << text;
    return path;
  }
  std::string world(const std::string& content) {
    return file("<sdf version='1.6'><world name='w'>" + content + "</world></sdf>");
  }
  static std::string model(const std::string& geometry, const std::string& pose = "0 0 0 0 0 0") {
    return "<model name='m'><static>true</static><pose>" + pose +
           "</pose><link name='l'><visual name='v'><geometry>" + geometry +
           "</geometry><material><diffuse>0.5 0.25 1 1</diffuse></material></visual><collision "
           "name='c'><geometry>" +
           geometry + "</geometry></collision></link></model>";
  }
  static std::string messageOf(const std::string& path) {
    try {
      loadWorld(path);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

TEST_F(WorldLoader, NamesFileAndReasonOfWhatItCannotLoad) {
  EXPECT_EQ(messageOf("/no/such.world"),
            "/no/such.world: cannot be read (No such file or directory; must be a world in SDF)");
  EXPECT_EQ(messageOf(folder_.string()),
            folder_.string() + ": cannot be read (is a folder; must be a world in SDF)");
  const auto empty = world("");
  EXPECT_EQ(messageOf(empty), empty + ": the world has nothing to show (no visual with triangles)");
  const auto broken = file("<sdf version='1.6'><world");
  EXPECT_EQ(messageOf(broken), broken + ":1: not XML: parsing element (must be a world in SDF)");
  const auto nothing = file("");
  EXPECT_EQ(messageOf(nothing), nothing + ": not XML: empty document (must be a world in SDF)");
}

TEST_F(WorldLoader, PlacesABoxWithItsColourAndOutline) {
  // A box of 2 x 1 x 1 m, turned by 90 degrees at (3, 0, 0.5): x from 2.5 to 3.5, y from -1 to 1.
  const auto loaded = loadWorld(world(model("<box><size>2 1 1</size></box>", "3 0 0.5 0 0 1.5707963")));
  ASSERT_EQ(loaded.world.bodyCount(), 1);
  const WorldModel& placed = loaded.world.models[0];
  EXPECT_EQ(placed.name, "m");
  const WorldBody& body = placed.bodies[0];
  EXPECT_EQ(body.name, "l/v");
  EXPECT_EQ(body.triangles.size(), 12U);
  EXPECT_TRUE(body.color.isApprox(Eigen::Vector3f(0.5F, 0.25F, 1.0F)));
  Eigen::AlignedBox3f box;
  for (const auto& v : body.vertices) box.extend(placed.pose.cast<float>() * v);
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(2.5F, -1, 0), 1e-4F) ||
              (box.min() - Eigen::Vector3f(2.5F, -1, 0)).norm() < 1e-4F);
  EXPECT_LT((box.max() - Eigen::Vector3f(3.5F, 1, 1)).norm(), 1e-4F);
  const auto obstacles = obstaclesOf(loaded.world);
  ASSERT_EQ(obstacles.size(), 1U);
  EXPECT_EQ(obstacles[0].name, "m/l/c");
  Eigen::AlignedBox2d outline;
  for (const auto& p : obstacles[0].outline) outline.extend(p);
  EXPECT_EQ(obstacles[0].outline.size(), 4U);
  EXPECT_LT((outline.min() - Eigen::Vector2d(2.5, -1)).norm(), 1e-4);
  EXPECT_LT((outline.max() - Eigen::Vector2d(3.5, 1)).norm(), 1e-4);
}

TEST_F(WorldLoader, WarnsOfWhatItLeavesOut) {
  const auto loaded = loadWorld(
      world("<include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include>" +
            model("<mesh><uri>model://lost/lost.dae</uri></mesh>") +
            "<light name='lamp' type='point'><pose>0 0 1 0 0 0</pose></light>"));
  EXPECT_EQ(loaded.world.bodyCount(), 1) << "the built-in ground plane";
  ASSERT_EQ(loaded.world.lights.size(), 1U);
  EXPECT_NEAR(loaded.world.lights[0].color.x(), 0.8F, 1e-5F) << "the built-in sun";
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("\"m/l/v\": mesh model://lost/lost.dae not found")));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("light \"lamp\" is not directional")));
}

TEST_F(WorldLoader, ObstaclesAreOnlyWhatTheBodyOfTheRobotCanMeet) {
  const auto marking = loadWorld(world(model("<box><size>1 1 0.002</size></box>", "0 0 0.001 0 0 0")));
  EXPECT_TRUE(obstaclesOf(marking.world).empty());
  const auto lamp = loadWorld(world(model("<box><size>1 1 0.1</size></box>", "0 0 2 0 0 0")));
  EXPECT_TRUE(obstaclesOf(lamp.world).empty());
}

TEST_F(WorldLoader, ReadsMeshesBesideTheWorld) {
  std::ofstream(folder_ / "wedge.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const auto loaded = loadWorld(world(model("<mesh><uri>wedge.obj</uri><scale>2 2 2</scale></mesh>")));
  ASSERT_EQ(loaded.world.bodyCount(), 1) << testing::PrintToString(loaded.warnings);
  EXPECT_EQ(loaded.world.models[0].bodies[0].triangles.size(), 4U);
  float highest = 0;
  for (const auto& v : loaded.world.models[0].bodies[0].vertices) highest = std::max(highest, v.z());
  EXPECT_FLOAT_EQ(highest, 2.0F);
}

TEST(Shapes, PrismOverAConcavePolygonHasItsAreaOnTop) {
  // An L of three unit squares, clockwise.
  const auto mesh = prismMesh({{0, 0}, {0, 2}, {1, 2}, {1, 1}, {2, 1}, {2, 0}}, 0.5);
  double top = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f n =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    if (n.z() > 1e-6F) top += 0.5 * n.z();
  }
  EXPECT_NEAR(top, 3.0, 1e-6);
  EXPECT_TRUE(prismMesh({{0, 0}, {1, 1}}, 0.5).triangles.empty());
}

TEST(Shapes, HullOfASquareWithPointsInsideIsTheSquare) {
  const auto hull = convexHull({{0, 0}, {1, 0}, {0.5, 0.5}, {1, 1}, {0, 1}, {0.5, 0}});
  EXPECT_EQ(hull.size(), 4U);
}

}  // namespace
}  // namespace vismem
