#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
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
            "<actor name='a'><skin><filename>a.dae</filename></skin></actor>"));
  EXPECT_EQ(loaded.world.bodyCount(), 1) << "the built-in ground plane";
  ASSERT_EQ(loaded.world.lights.size(), 1U);
  EXPECT_NEAR(loaded.world.lights[0].color.x(), 0.8F, 1e-5F) << "the built-in sun";
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("\"m/l/v\": mesh model://lost/lost.dae not found")));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("<actor> is not simulated")));
}

TEST_F(WorldLoader, BadNumbersAreNamedAndLeftOut) {
  const std::string box = "<box><size>1 1 1</size></box>";
  for (const auto& [content, warning] : std::vector<std::pair<std::string, std::string>>{
           {model(box, "nan 0 0 0 0 0"), "pose that is not finite"},
           {model(box, "1e300 0 0 0 0 0"), "pose that is not finite or farther than 1000 km"},
           {model("<box><size>1 -1 1</size></box>"), "a box of -1.0"},
           {model("<box><size>1 nan 1</size></box>"), "a box of "},
           {model("<cylinder><radius>0</radius><length>1</length></cylinder>"), "a cylinder of 0"},
           {model("<sphere><radius>1e30</radius></sphere>"), "a sphere of 1"},
           {model("<polyline><point>0 0</point><point>1 1</point><height>1</height></polyline>"),
            "no area"}}) {
    LoadedWorld loaded;
    try {
      loaded = loadWorld(world("<include><uri>model://ground_plane</uri></include>" + content));
    } catch (const ConfigError& error) {
      // libsdformat reads no NaN: then there is no world.
      EXPECT_THAT(error.what(), HasSubstr("nan")) << content;
      continue;
    }
    EXPECT_THAT(loaded.warnings, Contains(HasSubstr(warning))) << content;
    for (const auto& m : loaded.world.models) {
      EXPECT_TRUE(m.pose.matrix().allFinite());
      for (const auto& body : m.bodies) {
        for (const auto& v : body.vertices) ASSERT_TRUE(v.allFinite()) << content;
      }
    }
  }
}

TEST_F(WorldLoader, BadFilesThatAWorldNamesAreWarnings) {
  const auto put = [&](const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  };
  put("empty.dae", "");
  put("broken.dae", "<COLLADA><library_geometries><geometry>");
  put("broken.obj", "v 0 0\nf 1 2 99999\n");
  put("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("broken.stl", std::string("solid x\0\xff", 9));
  put("text.png", "no picture");
  put("look.obj", "mtllib look.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  put("look.mtl", "newmtl m\nmap_Kd text.png\n");
  std::string content = "<include><uri>model://ground_plane</uri></include>";
  for (const char* file : {"empty.dae", "broken.dae", "broken.obj", "nan.obj", "broken.stl", "look.obj"}) {
    std::string m = model("<mesh><uri>" + std::string(file) + "</uri></mesh>");
    m.replace(m.find("name='m'"), 8, "name='" + std::string(file) + "'");
    content += m;
  }
  content +=
      "<model name='h'><link name='l'><visual name='v'><geometry><heightmap><uri>text.png</uri><size>1 1 "
      "1</size>"
      "</heightmap></geometry></visual></link></model>";
  const auto loaded = loadWorld(world(content));
  for (const char* file : {"empty.dae", "broken.dae", "broken.stl", "text.png"}) {
    EXPECT_THAT(loaded.warnings, Contains(HasSubstr(file)));
  }
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("not a picture in a known format")));
  for (const auto& m : loaded.world.models) {
    for (const auto& body : m.bodies) {
      for (const auto& v : body.vertices) ASSERT_TRUE(v.allFinite()) << m.name;
      for (const auto& t : body.triangles) ASSERT_LT(t.maxCoeff(), body.vertices.size()) << m.name;
    }
  }
}

TEST_F(WorldLoader, AModelThatIncludesItselfIsAnError) {
  std::filesystem::create_directories(folder_ / "a");
  std::filesystem::create_directories(folder_ / "b");
  const auto put = [&](const std::string& name, const std::string& other) {
    std::ofstream(folder_ / name / "model.config")
        << "<model><name>" << name << "</name><sdf version='1.6'>model.sdf</sdf></model>";
    std::ofstream(folder_ / name / "model.sdf")
        << "<sdf version='1.6'><model name='" << name << "'><include><uri>model://" << other
        << "</uri></include></model></sdf>";
  };
  put("a", "b");
  put("b", "a");
  EXPECT_THAT(messageOf(world("<include><uri>model://a</uri></include>")),
              HasSubstr("model://a includes itself"));
}

TEST_F(WorldLoader, TextsThatAreNotUtf8) {
  const auto loaded =
      loadWorld(file("<sdf version='1.6'><world name='w'>" +
                     model("<box><size>1 1 1</size></box>").replace(13, 1, "caf\xe9") + "</world></sdf>"));
  ASSERT_EQ(loaded.world.models.size(), 1U);
  EXPECT_EQ(loaded.world.models[0].name, "caf\xc3\xa9");
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("is not UTF-8: read as Latin-1")));
  const std::string wide("\xff\xfe<\0s\0d\0f\0", 10);
  EXPECT_THAT(messageOf(file(wide)), HasSubstr("is not text in UTF-8 (it holds zero bytes)"));
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
