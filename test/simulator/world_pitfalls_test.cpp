// Errors and special features of third-party world files, each with a small world in test/data/worlds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "simulator/core/renderer.h"
#include "simulator/core/world.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string kFolder = std::string(VISMEM_SOURCE_DIR) + "/test/data/worlds";

LoadedWorld load(const std::string& name) {
  return loadWorld(kFolder + "/" + name + ".world", {kFolder + "/models"});
}

const WorldModel& modelOf(const World& world, const std::string& name) {
  const auto index = world.modelNamed(name);
  if (!index) throw std::runtime_error("no model " + name);
  return world.models[*index];
}

Eigen::AlignedBox3f boundsOf(const WorldModel& model) {
  Eigen::AlignedBox3f box;
  for (const auto& body : model.bodies) {
    for (const auto& v : body.vertices) box.extend(model.pose.cast<float>() * v);
  }
  return box;
}

void expectBounds(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  EXPECT_LT((box.min() - low).norm(), 1e-3F) << box.min().transpose();
  EXPECT_LT((box.max() - high).norm(), 1e-3F) << box.max().transpose();
}

/// Colour of the first surface without light's part: the channels' shares.
Eigen::Vector3f hueOf(const Renderer& renderer, const Eigen::Vector3d& from, const Eigen::Vector3d& towards) {
  const auto hit = renderer.cast(from, towards - from);
  if (!hit) return Eigen::Vector3f::Zero();
  return hit->color / std::max(hit->color.maxCoeff(), 1e-6F);
}

TEST(WorldPitfalls, P01ComplaintsAboutWhatNoLookNeedsAreNone) {
  const auto loaded = load("01_complaints");
  EXPECT_EQ(loaded.world.bodyCount(), 2);
  EXPECT_THAT(loaded.warnings, IsEmpty());
  EXPECT_EQ(loaded.summary(), "2 of 2 visuals");
}

TEST(WorldPitfalls, P02AttributesWithoutQuotesAreRepaired) {
  const auto loaded = load("02_bare_attributes");
  ASSERT_EQ(loaded.world.models.size(), 1U);
  EXPECT_EQ(loaded.world.models[0].name, "box");
  EXPECT_EQ(loaded.world.models[0].bodies[0].name, "link/body");
  EXPECT_THAT(loaded.warnings,
              Contains(HasSubstr("4 attribute value(s) without quotes, such as 1 user_camera box")));
}

TEST(WorldPitfalls, P03GroundPlaneAndSunAreBuiltIn) {
  const auto loaded = load("03_built_in");
  EXPECT_THAT(loaded.warnings, IsEmpty());
  ASSERT_EQ(loaded.world.lights.size(), 1U);
  EXPECT_EQ(loaded.world.lights[0].name, "sun");
  EXPECT_NEAR(boundsOf(modelOf(loaded.world, "ground_plane")).max().z(), 0.0F, 1e-6F);
  EXPECT_NEAR(boundsOf(modelOf(loaded.world, "upper_floor")).max().z(), 3.0F, 1e-6F);
}

TEST(WorldPitfalls, P04ModelConfigMayNameAnOldFileOrBeMissing) {
  const auto loaded = load("04_old_config");
  expectBounds(boundsOf(modelOf(loaded.world, "old")), {-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});
  expectBounds(boundsOf(modelOf(loaded.world, "no_config")), {1.5F, -0.5F, -0.5F}, {2.5F, 0.5F, 0.5F});
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("has no model.config: its model.sdf is used")));
}

TEST(WorldPitfalls, P05ThingsAreFoundBesideTheWorldAndByTheNameOfTheirModel) {
  const auto loaded = load("05_where_things_are");
  expectBounds(boundsOf(modelOf(loaded.world, "beside")), {-0.5F, -0.5F, 0}, {0.5F, 0.5F, 1});
  expectBounds(boundsOf(modelOf(loaded.world, "crate")), {1.5F, -0.5F, 0}, {2.5F, 0.5F, 1});
  expectBounds(boundsOf(modelOf(loaded.world, "called")), {3.5F, -0.5F, 0}, {4.5F, 0.5F, 1});
  EXPECT_FALSE(loaded.world.modelNamed("nowhere"));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("mesh model://nowhere/meshes/lost.dae not found")));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("model://wooden_crate/meshes/crate.obj taken from")));
}

TEST(WorldPitfalls, P06OgreMaterials) {
  const auto loaded = load("06_materials");
  const auto look = [&](const char* name) -> const WorldBody& {
    return modelOf(loaded.world, name).bodies[0];
  };
  EXPECT_TRUE(look("grey").color.isApprox(Eigen::Vector3f(0.7F, 0.7F, 0.7F)));
  EXPECT_TRUE(look("black").color.isApprox(Eigen::Vector3f(0.1F, 0.1F, 0.1F)));
  EXPECT_TRUE(look("painted").color.isApprox(Eigen::Vector3f(0.9F, 0.5F, 0.1F)));
  EXPECT_FALSE(look("painted").texture);
  ASSERT_TRUE(look("labelled").texture) << testing::PrintToString(loaded.warnings);
  EXPECT_EQ(look("labelled").texture->width, 64);
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("material Nobody/Knows not found")));
  for (const char* fine : {"grey", "black", "painted", "labelled"}) {
    EXPECT_THAT(loaded.warnings, Not(Contains(HasSubstr("\"" + std::string(fine) + "/link")))) << fine;
  }
}

TEST(WorldPitfalls, P07UpAxisOfColladaIsIgnoredAndItsUnitIsNot) {
  const auto loaded = load("07_up_axis");
  // 40 inches high along the file's y, 21 wide; the world turns y up.
  expectBounds(boundsOf(modelOf(loaded.world, "flag")), {-0.0254F, -0.0254F, 0}, {0.5334F, 0.0254F, 1.016F});
}

TEST(WorldPitfalls, P08SubMeshesByName) {
  const auto loaded = load("08_sub_meshes");
  expectBounds(boundsOf(modelOf(loaded.world, "all")), {-0.0254F, 0, -0.0254F}, {0.5334F, 1.016F, 0.0254F});
  expectBounds(boundsOf(modelOf(loaded.world, "cloth")), {-0.254F, -0.127F, 0}, {0.254F, 0.127F, 0});
  EXPECT_FALSE(loaded.world.modelNamed("none"));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("holds no triangles called \"wind\"")));
}

TEST(WorldPitfalls, P09TexturesAreFoundAndTheRightWayUp) {
  const auto loaded = load("09_textures");
  const Renderer renderer(loaded.world);
  // The crate's label on its -y side: red above; green below on the left, blue below on the right.
  const Eigen::Vector3d eye(0, -3, 0.5);
  const auto above = hueOf(renderer, eye, {0, -0.5, 0.75});
  const auto left = hueOf(renderer, eye, {-0.25, -0.5, 0.25});
  const auto right = hueOf(renderer, eye, {0.25, -0.5, 0.25});
  EXPECT_GT(above.x(), 4 * above.y());
  EXPECT_GT(left.y(), 3 * left.x());
  EXPECT_GT(right.z(), 3 * right.x());
  // The flag's picture lies beside the Collada file, which names a folder that is nowhere.
  bool textured = false;
  for (const auto& body : modelOf(loaded.world, "flag").bodies)
    textured = textured || body.texture != nullptr;
  EXPECT_TRUE(textured);
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("texture lost.png of ")));
  EXPECT_TRUE(modelOf(loaded.world, "lost").bodies[0].color.isApprox(Eigen::Vector3f(0.2F, 0.4F, 0.6F)));
}

TEST(WorldPitfalls, P10HeightmapsAreGridsOfTheirPicture) {
  const auto loaded = load("10_heightmap");
  // A roof along y, 2 m high, 8 x 4 m, moved by (1, 0, 0.5).
  expectBounds(boundsOf(modelOf(loaded.world, "hill")), {-3, -2, 0.5F}, {5, 2, 2.5F});
  const Renderer renderer(loaded.world);
  // A quarter of the way up the slope from the left edge: x = -2, height 0.5 + 0.5.
  const auto hit = renderer.cast({-2, 0.3, 10}, {0, 0, -1});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 10 - 1.0, 0.02);
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("heightmap file://media/valley.png not found")));
}

TEST(WorldPitfalls, P11JointsAreNotNeededForTheShape) {
  const auto loaded = load("11_joints");
  // The head's cylinder lies along x at 0.5 m.
  expectBounds(boundsOf(modelOf(loaded.world, "pioneer")), {0.8F, 1.8F, -0.1F}, {1.2F, 2.2F, 0.55F});
}

TEST(WorldPitfalls, P12CamerasSayTheirLensNoiseAndRate) {
  const auto loaded = load("12_camera");
  ASSERT_EQ(loaded.world.cameras.size(), 1U);
  const WorldCamera& camera = loaded.world.cameras[0];
  EXPECT_EQ(camera.name, "watcher/head/eye");
  EXPECT_EQ(camera.intrinsics.width, 640);
  EXPECT_EQ(camera.intrinsics.height, 480);
  EXPECT_NEAR(camera.intrinsics.fx, 320.0 / std::tan(1.57 / 2), 0.5);
  EXPECT_DOUBLE_EQ(camera.intrinsics.k1, -0.25);
  EXPECT_DOUBLE_EQ(camera.intrinsics.k2, 0.12);
  EXPECT_DOUBLE_EQ(camera.intrinsics.k3, 0.01);
  EXPECT_DOUBLE_EQ(camera.intrinsics.p1, -0.0003);
  EXPECT_DOUBLE_EQ(camera.intrinsics.p2, 0.0002);
  EXPECT_DOUBLE_EQ(camera.noise_sigma, 0.007);
  EXPECT_DOUBLE_EQ(camera.rate_hz, 25.0);
  // The model looks along y; the sensor sits 20 cm ahead and looks 0.1 rad down.
  EXPECT_LT((camera.T_world_camera.translation() - Eigen::Vector3d(0, 0.2, 1)).norm(), 1e-6);
  const Eigen::Vector3d axis = camera.T_world_camera.linear().col(2);
  EXPECT_LT((axis - Eigen::Vector3d(0, std::cos(0.1), -std::sin(0.1))).norm(), 1e-6);
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("camera \"watcher/head/blind\"")));
}

TEST(WorldPitfalls, P13RoundThingsShadowThemselvesWithoutSteps) {
  const auto loaded = load("13_round_in_the_sun");
  const Renderer renderer(loaded.world);
  // Light comes from -x, a little from above. Along the equator from the lit side to the dark one brightness
  // falls without jumps, on the fine ball and on one of six rings of ten faces.
  for (const auto& [y, largest_step] : {std::pair{0.0, 0.02}, std::pair{5.0, 0.06}}) {
    double before = 10.0;
    for (int degrees = 180; degrees >= 0; --degrees) {
      const double a = degToRad(degrees);
      const Eigen::Vector3d p(std::cos(a), y - std::sin(a), 0.0);
      const Eigen::Vector3d eye(3 * std::cos(a), y - 3 * std::sin(a), 0.0);
      const auto hit = renderer.cast(eye, p - eye);
      ASSERT_TRUE(hit);
      const double brightness = hit->color.x();
      if (before < 10.0) {
        EXPECT_LT(std::abs(brightness - before), largest_step) << "ball at y = " << y << ", " << degrees;
      }
      before = brightness;
    }
    EXPECT_NEAR(before, 0.45 * 0.85 * 0.7, 0.15) << "the dark side has the ambient light only";
  }
}

TEST(WorldPitfalls, LightsShineFromTheirPlaceWithinTheirConeAndRange) {
  const std::string text =
      "<sdf version='1.6'><world name='w'><scene><ambient>0 0 0 1</ambient></scene>"
      "<model name='floor'><static>true</static><link name='l'><visual name='v'><geometry><box><size>20 20 "
      "0.1"
      "</size></box></geometry><material><diffuse>1 1 1 1</diffuse></material></visual></link></model>"
      "<light name='lamp' type='point'><pose>-5 0 2 0 0 0</pose><diffuse>0.5 0.5 0.5 1</diffuse>"
      "<attenuation><range>4</range><constant>1</constant><linear>0</linear><quadratic>0</quadratic></"
      "attenuation>"
      "</light>"
      "<light name='beam' type='spot'><pose>5 0 2 0 0 0</pose><diffuse>0 0 1 1</diffuse><direction>0 0 -1"
      "</direction><attenuation><range>10</range><constant>1</constant><linear>0</linear></attenuation>"
      "<spot><inner_angle>0.4</inner_angle><outer_angle>0.8</outer_angle><falloff>1</falloff></spot></light>"
      "</world></sdf>";
  const auto loaded = parseWorld(text, "lights", {});
  ASSERT_EQ(loaded.world.lights.size(), 2U) << testing::PrintToString(loaded.warnings);
  const Renderer renderer(loaded.world);
  const auto at = [&](double x, double y) { return renderer.cast({x, y, 5}, {0, 0, -1})->color; };
  EXPECT_NEAR(at(-5, 0).x(), 0.5F, 0.01F) << "right below the lamp";
  EXPECT_GT(at(-5, 0).x(), at(-5, 2).x());
  EXPECT_FLOAT_EQ(at(-5, 4).x(), 0.0F) << "out of its range";
  EXPECT_NEAR(at(5, 0).z(), 1.0F, 0.01F) << "below the beam";
  EXPECT_FLOAT_EQ(at(5, 1.5).z(), 0.0F) << "out of its cone";
  EXPECT_FLOAT_EQ(at(5, 0).x(), 0.0F) << "blue only";
}

TEST(WorldPitfalls, ASavedStateSaysWhereModelsAre) {
  const std::string text =
      "<sdf version='1.6'><world name='w'><model name='box'><pose>1 0 0 0 0 0</pose><link name='l'><visual "
      "name='v'><geometry><box><size>1 1 1</size></box></geometry></visual></link></model>"
      "<state world_name='w'><model name='box'><pose>4 5 0.5 0 0 0</pose></model></state></world></sdf>";
  const auto loaded = parseWorld(text, "saved", {});
  EXPECT_LT((loaded.world.models[0].pose.translation() - Eigen::Vector3d(4, 5, 0.5)).norm(), 1e-6);
}

TEST(WorldPitfalls, AHouseIsNotOneBlockToTheRobot) {
  // An L of 4 x 4 m with arms 1 m wide, as a polyline: its inner corner is free.
  const std::string shape =
      "<geometry><polyline><point>0 0</point><point>4 0</point><point>4 1</point><point>1 1</point><point>1 4"
      "</point><point>0 4</point><height>1</height></polyline></geometry>";
  const std::string text =
      "<sdf version='1.6'><world name='w'><model name='l'><static>true</static><pose>0 0 0 0 0 "
      "1.5707963</pose>"
      "<link name='l'><visual name='v'>" +
      shape + "</visual><collision name='c'>" + shape + "</collision></link></model></world></sdf>";
  const auto loaded = parseWorld(text, "house", {});
  const auto inside = [&](double x, double y) {
    for (const auto& obstacle : obstaclesOf(loaded.world)) {
      bool in = true;
      for (std::size_t i = 0; i < obstacle.outline.size(); ++i) {
        const Eigen::Vector2d a = obstacle.outline[i];
        const Eigen::Vector2d d = obstacle.outline[(i + 1) % obstacle.outline.size()] - a;
        in = in && d.x() * (y - a.y()) - d.y() * (x - a.x()) >= 0.0;
      }
      if (in) return true;
    }
    return false;
  };
  // Turned by a quarter: the arms lie along y from 0 to 4 and along -x.
  EXPECT_TRUE(inside(-0.99, 2.0) || inside(-1.01, 2.0)) << "its wall";
  EXPECT_FALSE(inside(-2.5, 2.5)) << "the room between its arms";
  EXPECT_FALSE(inside(1.0, 1.0));
}

TEST(WorldPitfalls, ModelsAreFoundByNameAndByFile) {
  const auto modelOf = [](const std::string& uri) {
    const std::string text =
        "<sdf version='1.9'><world name='one'><include><uri>" + uri + "</uri></include></world></sdf>";
    return parseWorld(text, "one.world", {kFolder + "/models"}).world.models.front();
  };
  const auto crate = modelOf("model://crate");
  EXPECT_EQ(crate.name, "crate");
  EXPECT_EQ(crate.bodies.size(), 1U);
  EXPECT_FALSE(crate.outlines.empty());
  EXPECT_EQ(modelOf(kFolder + "/models/no_config/model.sdf").name, "no_config");
  EXPECT_THROW(modelOf("model://nobody"), ConfigError);
}

}  // namespace
}  // namespace vismem
