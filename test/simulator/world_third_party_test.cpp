// Third-party worlds and models: an invalid part of a file does not affect the rest, and a warning names the
// missing part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/config/config_error.h"
#include "simulator/core/renderer.h"
#include "simulator/core/world.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

const std::string kVisual = "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>";
const std::string kBox = "<link name='l'>" + kVisual + "</link>";

class ThirdPartyWorlds : public testing::Test {
 protected:
  ThirdPartyWorlds() : folder_(fs::path(testing::TempDir()) / ("third_party_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ThirdPartyWorlds() override { fs::remove_all(folder_); }

  static std::string sdf(const std::string& content, const std::string& version = "version='1.6'") {
    return "<sdf " + version + ">\n<world name='w'>\n" + content + "</world></sdf>";
  }
  LoadedWorld load(const std::string& text) { return parseWorld(text, "w.world", {folder_}); }
  void put(const std::string& name, const std::string& bytes) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  /// A model in a folder of its own; `sdf` is its file.
  void putModel(const std::string& name, const std::string& sdf) {
    put(name + "/model.config", "<model><name>" + name + "</name><sdf version='1.6'>model.sdf</sdf></model>");
    put(name + "/model.sdf", sdf);
  }
  static std::vector<std::string> names(const World& world) {
    std::vector<std::string> result;
    for (const auto& model : world.models) {
      for (const auto& body : model.bodies) result.push_back(model.name + "/" + body.name);
    }
    return result;
  }
  static Eigen::AlignedBox3f bounds(const World& world, const std::string& name) {
    Eigen::AlignedBox3f box;
    const auto index = world.modelNamed(name);
    if (!index) throw std::runtime_error("no model " + name);
    const WorldModel& model = world.models[*index];
    for (const auto& body : model.bodies) {
      for (const auto& v : body.vertices) box.extend(model.pose.cast<float>() * v);
    }
    return box;
  }
  static void expectBounds(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& low,
                           const Eigen::Vector3f& high) {
    EXPECT_LT((box.min() - low).norm(), 1e-3F) << box.min().transpose();
    EXPECT_LT((box.max() - high).norm(), 1e-3F) << box.max().transpose();
  }

  fs::path folder_;
};

TEST_F(ThirdPartyWorlds, NumbersThatAreNotFiniteCostOnlyWhatNeedsThem) {
  // As saved after a simulation that went wrong: in inertias, velocities and poses.
  const auto loaded =
      load(sdf("<model name='wall'><link "
               "name='l'><inertial><inertia><ixx>nan</ixx><iyy>-nan</iyy><izz>inf</izz></inertia>"
               "<mass>0</mass></inertial>" +
               kVisual +
               "</link></model>\n"
               "<model name='gone'><pose>nan NaN 0 0 0 0</pose>" +
               kBox +
               "</model>\n"
               "<model name='large'><link name='l'><visual name='v'><geometry><box><size>inf 1 "
               "1</size></box></geometry>"
               "</visual></link></model>\n"
               "<state world_name='w'><model name='wall'><pose>nan 0 0 0 0 0</pose><link "
               "name='l'><velocity>nan nan 0 0 0 0"
               "</velocity></link></model></state>"));
  EXPECT_THAT(names(loaded.world), ElementsAre("wall/l/v"));
  EXPECT_TRUE(loaded.world.models[0].pose.isApprox(Pose3::Identity()));
  EXPECT_THAT(
      loaded.warnings,
      IsSupersetOf(
          {"w.world: line 3: a number of <ixx> is not finite",
           "w.world: line 4: a number of <pose> is not finite (2 times)",
           "w.world: model \"gone\" has a pose that is not finite or farther than 1000 km: left out"}));
}

TEST_F(ThirdPartyWorlds, WhatLibsdformatRefusesWholeWorldsForIsRepaired) {
  const auto loaded =
      load(sdf("<light type='point' name='lamp'><diffuse>2 1.5 0.5 1</diffuse></light>\n"
               "<model><link><visual><geometry><box><size>1 1 1</size></box></geometry><material>"
               "<ambient>255 128 0</ambient></material></visual><visual name=''><geometry><sphere>"
               "<radius>1</radius></sphere></geometry></visual></link></model>",
               ""));
  ASSERT_EQ(loaded.world.models.size(), 1U) << testing::PrintToString(loaded.warnings);
  EXPECT_EQ(loaded.world.models[0].bodies.size(), 2U);
  EXPECT_TRUE(loaded.world.models[0].bodies[0].color.isApprox(Eigen::Vector3f(1, 1, 0)));
  ASSERT_EQ(loaded.world.lights.size(), 1U);
  EXPECT_THAT(loaded.warnings,
              IsSupersetOf({"w.world: line 1: no version of SDF: 1.6 is assumed",
                            "w.world: line 3: <diffuse> is outside 0..1: the nearest colour is taken",
                            "w.world: line 4: <ambient> is outside 0..1: the nearest colour is taken",
                            "w.world: line 4: <visual> has no name (2 times)",
                            "w.world: line 4: <link> has no name", "w.world: line 4: <model> has no name"}));
}

TEST_F(ThirdPartyWorlds, OneRefusedPartOfAModelCostsThatPart) {
  // A size that is no numbers makes libsdformat give up the world.
  const auto loaded = load(sdf(
      "<model name='before'>" + kBox + "</model>\n<model name='partly'>\n<link name='good'>" + kVisual +
      "</link>\n<link name='bad'>" + kVisual +
      "\n<visual name='broken'><geometry><box><size>one 1 1</size></box></geometry></visual>"
      "\n<visual name='too'><geometry><box><size>1 two 1</size></box></geometry></visual></link></model>\n"
      "<physics type='ode'><max_step_size>soon</max_step_size></physics>\n<model name='after'>" +
      kBox + "</model>"));
  const auto shown = names(loaded.world);
  EXPECT_THAT(shown, IsSupersetOf({"before/l/v", "partly/good/v", "partly/bad/v", "after/l/v"}))
      << testing::PrintToString(loaded.warnings);
  EXPECT_THAT(
      loaded.warnings,
      Contains(testing::StartsWith("w.world: line 7: <size> of <model name=\"partly\"> is left out: ")));
  EXPECT_THAT(loaded.warnings, Contains(testing::StartsWith("w.world: line 9: <max_step_size> of <physics")));
}

TEST_F(ThirdPartyWorlds, OneBrokenModelFileCostsThatModel) {
  putModel("good", "<sdf version='1.6'><model name='good'>" + kBox + "</model></sdf>");
  putModel("bad_xml", "<sdf version='1.6'><model name='bad_xml'>" + kBox + "</sdf>");
  putModel("bare", "<sdf version=1.6><model name='bare'><link name=l>" + kVisual + "</link></model></sdf>");
  putModel(
      "bright",
      "<sdf version='1.6'><model name='bright'><pose>0 0 9 0 0 0</pose><link name='l'><visual name='v'>"
      "<geometry><mesh><uri>part.obj</uri></mesh></geometry></visual><visual name='w'><geometry><box>"
      "<size>1 1 1</size></box></geometry><material><diffuse>7 0 0 1</diffuse></material></visual></link>"
      "</model></sdf>");
  put("bright/part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  putModel("empty", "");
  putModel("picture", std::string("\x89PNG\0\0", 6));
  fs::create_directories(folder_ / "nothing");
  put("lost_file/model.config", "<model><sdf version='1.6'>elsewhere.sdf</sdf></model>");
  std::string includes;
  int x = 0;
  for (const char* name :
       {"good", "bad_xml", "bare", "bright", "empty", "picture", "nothing", "lost_file", "nobody"}) {
    includes += "<include><uri>model://" + std::string(name) + "</uri><pose>" + std::to_string(x) +
                " 0 0 0 0 0</pose></include>\n";
    x += 2;
  }
  const auto loaded =
      load(sdf(includes + "<include/>\n<include><name>second</name><uri>model://bare</uri></include>"));
  EXPECT_THAT(names(loaded.world),
              testing::UnorderedElementsAre("good/l/v", "bare/l/v", "bright/l/v/defaultobject", "bright/l/w",
                                            "second/l/v"))
      << testing::PrintToString(loaded.warnings);
  expectBounds(bounds(loaded.world, "bare"), {3.5F, -0.5F, -0.5F}, {4.5F, 0.5F, 0.5F});
  expectBounds(bounds(loaded.world, "bright"), {5.5F, -0.5F, -0.5F}, {7, 1, 0.5F});
  for (const char* name : {"bad_xml", "empty", "picture", "nothing", "lost_file", "nobody"}) {
    EXPECT_THAT(loaded.warnings, Contains(HasSubstr(name)));
  }
}

TEST_F(ThirdPartyWorlds, NewerVersionsAndTheOldestThatWeClaim) {
  const std::string cone =
      "<model name='m'><static>true</static><link name='l'><visual "
      "name='v'><geometry><cone><radius>0.5</radius><length>2"
      "</length></cone></geometry></visual></link></model>";
  for (const char* version : {"1.9", "1.10", "1.11", "1.12"}) {
    const auto loaded = load(sdf(cone, "version='" + std::string(version) + "'"));
    expectBounds(bounds(loaded.world, "m"), {-0.5F, -0.5F, -1}, {0.5F, 0.5F, 1});
    const Renderer renderer(loaded.world);
    const auto side = renderer.cast({-2, 0, 0}, {1, 0, 0});
    ASSERT_TRUE(side);
    EXPECT_NEAR(side->distance_m, 1.75, 0.01) << "half as wide half way up";
    EXPECT_FALSE(side->from_inside);
    EXPECT_FALSE(renderer.cast({0, 0, -3}, {0, 0, 1})->from_inside);
  }
  for (const char* version : {"1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "1.8"}) {
    EXPECT_THAT(
        names(load(sdf("<model name='m'>" + kBox + "</model>", "version='" + std::string(version) + "'"))
                  .world),
        ElementsAre("m/l/v"));
  }
}

TEST_F(ThirdPartyWorlds, PosesInFramesOfAnyKind) {
  const auto loaded = load(
      sdf("<frame name='f'><pose degrees='true'>2 0 0 0 0 90</pose></frame>"
          "<model name='m'><pose relative_to='f'>1 0 0.5 0 0 0</pose><link name='a'>" +
              kVisual +
              "</link>"
              // On a joint's frame, which is on the child's.
              "<link name='c'><pose>0 0 1 0 0 0</pose></link><joint name='j' type='revolute'><pose>0 0 -0.5 "
              "0 0 0</pose>"
              "<parent>a</parent><child>c</child><axis><xyz>0 0 1</xyz></axis></joint>"
              "<link name='b'><pose relative_to='j'>0 0 1 0 0 0</pose><visual name='v'><pose "
              "relative_to='g'>0 0 0 0 0 0"
              "</pose><geometry><sphere><radius>0.1</radius></sphere></geometry></visual></link>"
              "<frame name='g' attached_to='a'><pose>0 5 0 0 0 0</pose></frame>"
              "<model name='n' placement_frame='y'><pose relative_to='g'>0 1 0 0 0 0</pose><link "
              "name='y'><pose>0.5 0 0 0 0 0"
              "</pose><visual name='v'><geometry><box><size>0.2 0.2 "
              "0.2</size></box></geometry></visual></link></model>"
              "</model><joint name='world_joint' type='fixed'><parent>world</parent><child>m</child></joint>",
          "version='1.9'"));
  ASSERT_THAT(names(loaded.world), ElementsAre("m/a/v", "m/b/v", "m/n/y/v"))
      << testing::PrintToString(loaded.warnings);
  // Frame f turns x to y: the model stands at (2, 1, 0.5); g is 5 m along the model's y, which is -x.
  const auto middleOf = [&](int body) {
    Eigen::AlignedBox3f box;
    for (const auto& v : loaded.world.models[0].bodies[body].vertices) {
      box.extend(loaded.world.models[0].pose.cast<float>() * v);
    }
    return Eigen::Vector3f(box.center());
  };
  EXPECT_LT((middleOf(0) - Eigen::Vector3f(2, 1, 0.5F)).norm(), 1e-3F) << middleOf(0).transpose();
  EXPECT_LT((middleOf(1) - Eigen::Vector3f(-3, 1, 0.5F)).norm(), 1e-3F) << middleOf(1).transpose();
  EXPECT_LT((middleOf(2) - Eigen::Vector3f(-4, 1, 0.5F)).norm(), 1e-3F) << middleOf(2).transpose();
}

TEST_F(ThirdPartyWorlds, WhatIsNotAboutLooksIsPassedOver) {
  const auto loaded = load(
      sdf("<audio><device>default</device></audio><wind><linear_velocity>1 0 0</linear_velocity></wind>"
          "<atmosphere type='adiabatic'/><gui fullscreen=0><plugin name='g' filename='libg.so'><a "
          "b=c/></plugin></gui>"
          "<physics type='ode' default=1 "
          "name='p'/><spherical_coordinates><surface_model>EARTH_WGS84</surface_model>"
          "</spherical_coordinates><magnetic_field>0 0 0</magnetic_field><plugin name='p' "
          "filename='x.so'><v>nan</v></plugin>"
          "<scene><sky><clouds/></sky><fog><type>linear</type></fog></scene>"
          "<model name='m'><allow_auto_disable>1</allow_auto_disable><link name='l'>" +
          kVisual +
          "<visual name='empty'><geometry><empty/></geometry></visual><visual "
          "name='image'><geometry><image><uri>x.png</uri>"
          "</image></geometry></visual><projector name='p'><texture>a.png</texture></projector><audio_sink/>"
          "<battery name='b'/><sensor name='lidar' type='ray'><ray/></sensor><sensor name='imu' type='imu'/>"
          "</link><gripper name='g'/></model>"
          "<actor name='walker'><skin><filename>walk.dae</filename></skin></actor><road "
          "name='r'><width>3</width><point>0 0 0"
          "</point></road><population name='p'><model name='c'><link name='l'/></model></population>"));
  EXPECT_THAT(names(loaded.world), ElementsAre("m/l/v"));
  for (const char* named : {"<actor> is not simulated", "<road> is not simulated",
                            "<population> is not simulated", "\"m/l/image\": <image> is not simulated"}) {
    EXPECT_THAT(loaded.warnings, Contains(HasSubstr(named)));
  }
  EXPECT_THAT(loaded.warnings, testing::Not(Contains(HasSubstr("m/l/empty"))));
}

TEST_F(ThirdPartyWorlds, LampsOnLinksShine) {
  const auto loaded =
      load(sdf("<scene><ambient>0 0 0 1</ambient></scene><model name='floor'><static>1</static><link "
               "name='l'><visual name='v'>"
               "<geometry><plane><normal>0 0 1</normal><size>20 "
               "20</size></plane></geometry><material><diffuse>1 1 1 1</diffuse>"
               "</material></visual></link></model><model name='lamp'><static>1</static><pose>3 0 0 0 0 "
               "0</pose><link name='l'>"
               "<pose>0 2 0 0 0 0</pose><light name='bulb' type='point'><pose>0 0 1 0 0 0</pose><diffuse>1 1 "
               "1 1</diffuse>"
               "<attenuation><range>5</range></attenuation></light></link></model>"));
  ASSERT_EQ(loaded.world.lights.size(), 1U) << testing::PrintToString(loaded.warnings);
  EXPECT_LT((loaded.world.lights[0].position - Eigen::Vector3f(3, 2, 1)).norm(), 1e-5F);
  const Renderer renderer(loaded.world);
  EXPECT_GT(renderer.cast({3, 2, 0.5}, {0, 0, -1})->color.x(), 0.4F);
  EXPECT_FLOAT_EQ(renderer.cast({-5, 2, 0.5}, {0, 0, -1})->color.x(), 0.0F);
}

TEST_F(ThirdPartyWorlds, AScaleThatOnlyTheStateHasIsNamed) {
  const auto loaded = load(sdf("<model name='m'>" + kBox +
                               "</model><state world_name='w'><model name='m'><scale>2 1 1"
                               "</scale></model></state>"));
  EXPECT_THAT(loaded.warnings, Contains("w.world: the scale of model \"m\" in <state> is not applied"));
}

// --- meshes ---

std::string binaryStl(const std::string& header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const std::uint32_t count = 1;
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0};
  bytes.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
  bytes.append(2, '\0');
  return bytes;
}

/// A triangle over (0,0,0) (2,0,0) (0,3,0) in nodes below each other.
std::string collada(const std::string& asset, const std::string& nodes) {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset>" +
         asset +
         "</asset><library_geometries><geometry id='g' name='tri'><mesh><source id='p'><float_array id='pa' "
         "count='9'>0 0 0 "
         "2 0 0 0 3 0</float_array><technique_common><accessor source='#pa' count='3' stride='3'><param "
         "name='X' "
         "type='float'/><param name='Y' type='float'/><param name='Z' "
         "type='float'/></accessor></technique_common></source>"
         "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles count='1'><input "
         "semantic='VERTEX' source='#v' offset='0'/><p>0 1 "
         "2</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id='s'>" +
         nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

TEST_F(ThirdPartyWorlds, MeshesInEveryFormatTheyCome) {
  put("binary.stl", binaryStl("made by a program"));
  put("solid.STL", binaryStl("solid but binary"));
  put("text.stl",
      "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 3 "
      "0\nendloop\nendfacet\n"
      "endsolid part\n");
  put("negative.obj",
      "# no normals, no mtl, indices from the end, a polygon of five\nmtllib lost.mtl\nusemtl paint\n"
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 3 0\nv 0 3 0\nf -5 -4 -3 -2 -1\n");
  const std::string instance = "<instance_geometry url='#g'/>";
  put("y_up.dae", collada("<unit meter='1'/><up_axis>Y_UP</up_axis>", "<node>" + instance + "</node>"));
  put("centimetres.DAE", collada("<unit meter='0.01' name='centimeter'/><up_axis>Z_UP</up_axis>",
                                 "<node><scale>100 100 100</scale>" + instance + "</node>"));
  put("nested.dae", collada("<up_axis>Z_UP</up_axis>",
                            "<node><translate>0 0 1</translate><node><scale>0.5 1 1</scale>" + instance +
                                "<node><translate>2 0 0</translate>" + instance + "</node></node></node>"));
  const auto shapeOf = [&](const std::string& file, const std::string& scale = "1 1 1") {
    const auto loaded =
        load(sdf("<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>" + file +
                 "</uri><scale>" + scale + "</scale></mesh></geometry></visual></link></model>"));
    return bounds(loaded.world, "m");
  };
  const Eigen::Vector3f zero(0, 0, 0);
  for (const char* file :
       {"binary.stl", "solid.STL", "text.stl", "negative.obj", "y_up.dae", "centimetres.DAE"}) {
    SCOPED_TRACE(file);
    expectBounds(shapeOf(file), zero, {2, 3, 0});
    expectBounds(shapeOf(file, "-1 2 1"), {-2, 0, 0}, {0, 6, 0});
  }
  expectBounds(shapeOf("nested.dae"), {0, 0, 1}, {2, 3, 1});
}

TEST_F(ThirdPartyWorlds, PicturesThatAreNoneCostTheirTexture) {
  put("zero.png", "");
  put("cut.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\0\0\0\0\0\x08\x02\0\0\0", 29));
  std::string content;
  for (const char* name : {"zero", "cut"}) {
    put(std::string(name) + ".obj", "mtllib " + std::string(name) +
                                        ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                        "usemtl m\nf 1/1 2/2 3/3\n");
    put(std::string(name) + ".mtl", "newmtl m\nKd 0.2 0.4 0.6\nmap_Kd " + std::string(name) + ".png\n");
    content += "<model name='" + std::string(name) +
               "'><link name='l'><visual name='v'><geometry><mesh><uri>" + name +
               ".obj</uri></mesh></geometry></visual></link></model>";
  }
  const auto loaded = load(sdf(content));
  ASSERT_EQ(loaded.world.bodyCount(), 2) << testing::PrintToString(loaded.warnings);
  for (const auto& model : loaded.world.models) {
    EXPECT_FALSE(model.bodies[0].texture);
    EXPECT_TRUE(model.bodies[0].color.isApprox(Eigen::Vector3f(0.2F, 0.4F, 0.6F)));
  }
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("zero.png: is empty")));
  EXPECT_THAT(loaded.warnings, Contains(HasSubstr("cut.png: not a picture in a known format")));
}

TEST_F(ThirdPartyWorlds, MirroredMeshesKeepTheirOutside) {
  // A tetrahedron with outward faces, mirrored in one and in three axes.
  put("tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  for (const Eigen::Vector3d& scale :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(-1, 1, 1), Eigen::Vector3d(-1, -1, -1)}) {
    std::ostringstream text;
    text << scale.transpose();
    const auto loaded = load(
        sdf("<model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>tetra.obj</uri><scale>" +
            text.str() + "</scale></mesh></geometry></visual></link></model>"));
    const Renderer renderer(loaded.world);
    const Eigen::Vector3d inside = 0.2 * scale;
    for (const Eigen::Vector3d& from :
         {Eigen::Vector3d(3, 0, 0), Eigen::Vector3d(-3, 0, 0), Eigen::Vector3d(0, 0, 3)}) {
      const auto hit = renderer.cast(inside + from, -from);
      ASSERT_TRUE(hit);
      EXPECT_FALSE(hit->from_inside) << text.str() << " from " << from.transpose();
    }
  }
}

TEST_F(ThirdPartyWorlds, FilesAreFoundWhereverWorldsSayTheyAre) {
  const std::string wedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  put("thing/meshes/part.obj", wedge);
  put("some_package/models/thing/meshes/part.obj", wedge);
  put("with space/part.obj", wedge);
  for (const std::string& uri :
       {std::string("model://thing/meshes/part.obj"), std::string("file://thing/meshes/part.obj"),
        std::string("thing/meshes/part.obj"), std::string("./thing/meshes/../meshes/part.obj"),
        "file://" + (folder_ / "thing/meshes/part.obj").string(),
        (folder_ / "thing/meshes/part.obj").string(),
        std::string("package://some_package/models/thing/meshes/part.obj"),
        std::string("https://fuel.gazebosim.org/1.0/Somebody/models/thing/2/files/meshes/part.obj"),
        std::string("model://with space/part.obj")}) {
    const auto loaded =
        load(sdf("<include><uri>model://ground_plane</uri></include><model name='m'><link name='l'><visual "
                 "name='v'><geometry><mesh><uri>" +
                 uri + "</uri></mesh></geometry></visual></link></model>"));
    EXPECT_TRUE(loaded.world.modelNamed("m")) << uri << testing::PrintToString(loaded.warnings);
  }
}

}  // namespace
}  // namespace vismem
