// Third-party worlds and models: an invalid part of a file does not affect the rest, and a warning names the
// missing part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "simulator/core/renderer.h"
#include "simulator/third_party_worlds.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

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
          {"w.world: line 4: a number of <pose> is not finite (2 times)",
           "w.world: model \"gone\" has a pose that is not finite or farther than 1000 km: left out"}));
  EXPECT_THAT(loaded.warnings, testing::Not(Contains(HasSubstr("<ixx>")))) << "no look needs an inertia";
  EXPECT_EQ(loaded.summary(), "1 of 3 visuals");
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
  EXPECT_THAT(shown,
              testing::UnorderedElementsAre("before/l/v", "partly/good/v", "partly/bad/v", "after/l/v"))
      << testing::PrintToString(loaded.warnings);
  EXPECT_THAT(loaded.warnings,
              Contains(testing::StartsWith(
                  "w.world: line 7: <visual name=\"broken\"> of <model name=\"partly\"> is left out: ")));
  EXPECT_THAT(loaded.warnings, testing::Not(Contains(HasSubstr("physics")))) << "no look needs it";
  EXPECT_EQ(loaded.summary(), "4 of 6 visuals");
}

TEST_F(ThirdPartyWorlds, WrongValuesOfWhatIsNotSimulatedCostNothing) {
  const std::string friction =
      "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry><surface><friction><ode>"
      "<mu>high</mu></ode></friction></surface></collision>";
  putModel("slippery", "<sdf version='1.6'><model name='slippery'><link name='l'>" + kVisual + friction +
                           "</link></model></sdf>");
  const auto loaded = load(sdf(
      "<physics type='ode'><max_step_size>soon</max_step_size></physics><gui><camera name='c'><pose>x</pose>"
      "</camera></gui><include><uri>model://slippery</uri><pose>5 0 0 0 0 0</pose></include>"
      "<model name='m'><plugin name='p' filename='f'><pose>none</pose></plugin><link name='l'>"
      "<inertial><mass>heavy</mass></inertial>" +
      kVisual + friction +
      "<sensor name='s' type='ray'><update_rate>fast</update_rate></sensor></link><link name='k'/>"
      "<joint name='j' type='revolute'><parent>l</parent><child>k</child><axis><xyz>0 0 0</xyz></axis>"
      "</joint></model>"));
  EXPECT_THAT(names(loaded.world), ElementsAre("m/l/v", "slippery/l/v"));
  EXPECT_THAT(loaded.warnings, IsEmpty());
  EXPECT_EQ(loaded.summary(), "2 of 2 visuals");
  expectBounds(bounds(loaded.world, "slippery"), {4.5F, -0.5F, -0.5F}, {5.5F, 0.5F, 0.5F});
}

TEST_F(ThirdPartyWorlds, APoseThatCannotBeReadLeavesItsElementOut) {
  const auto loaded = load(sdf(
      "<model name='here'><pose>1 0 0 0 0 0</pose>" + kBox +
      "</model>\n<model name='nowhere'><pose>3 x 0 0 0 0</pose>" + kBox +
      "</model>\n<model name='short'><pose>3 0 0</pose>" + kBox +
      "</model>\n<model name='m'><link name='l'>" + kVisual +
      "\n<visual name='w'><pose>1,0,0,0,0,0</pose><geometry><sphere><radius>1</radius></sphere></geometry>"
      "</visual></link></model>"));
  EXPECT_THAT(names(loaded.world), ElementsAre("here/l/v", "m/l/v"));
  EXPECT_THAT(
      loaded.warnings,
      ElementsAre("w.world: line 4: <model name=\"nowhere\"> is left out: its <pose> \"3 x 0 0 0 0\" "
                  "cannot be read (must be 6 numbers: x y z roll pitch yaw)",
                  "w.world: line 5: <model name=\"short\"> is left out: its <pose> \"3 0 0\" cannot be "
                  "read (must be 6 numbers: x y z roll pitch yaw)",
                  "w.world: line 7: <visual name=\"w\"> is left out: its <pose> \"1,0,0,0,0,0\" cannot "
                  "be read (must be 6 numbers: x y z roll pitch yaw)"));
  EXPECT_EQ(loaded.summary(), "2 of 5 visuals");
  EXPECT_FALSE(loaded.isWhole());
}

TEST_F(ThirdPartyWorlds, TheOldestRootAndItsAttributes) {
  const auto loaded = parseWorld(
      "<gazebo version='1.0'><world name='w'><model name='m' static='true'><origin pose='3 0 0 0 0 0'/>"
      "<link name='l'><origin pose='0 0 2 0 0 0'/><visual name='v'><geometry><box size='1 2 3'/></geometry>"
      "<material><diffuse rgba='0.2 0.4 0.6 1'/></material></visual><visual name='w'><geometry>"
      "<cylinder radius='0.1' length='4'/></geometry><material script='Gazebo/Red'/></visual></link></model>"
      "<model name='lost'><origin pose='a b c'/><link name='l'><visual name='v'><geometry>"
      "<box size='1 1 1'/></geometry></visual></link></model></world></gazebo>",
      "w.world", {});
  ASSERT_THAT(names(loaded.world), ElementsAre("m/l/v", "m/l/w")) << testing::PrintToString(loaded.warnings);
  expectBounds(bounds(loaded.world, "m"), {2.5F, -1.0F, 0.0F}, {3.5F, 1.0F, 4.0F});
  EXPECT_TRUE(loaded.world.models[0].bodies[0].color.isApprox(Eigen::Vector3f(0.2F, 0.4F, 0.6F)));
  EXPECT_TRUE(loaded.world.models[0].bodies[1].color.isApprox(Eigen::Vector3f(1, 0, 0)));
  // The oldest root names a script of a material without its place, which the library notes beside it.
  EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("<model name=\"lost\"> is left out"),
                                           HasSubstr("A <script> element is missing a child <uri>")));
  // A newer one of the same root.
  const auto newer = parseWorld(
      "<gazebo version='1.5'><world name='w'><model name='m'>" + kBox + "</model></world></gazebo>",
      "w.world", {});
  EXPECT_THAT(names(newer.world), ElementsAre("m/l/v"));
}

TEST_F(ThirdPartyWorlds, AWorldThatLoadsIsNotSaidToFail) {
  // Two models of one name: libsdformat drops the second and says that it failed to load the world.
  const auto loaded =
      load(sdf("<model name='m'>" + kBox + "</model>\n<model name='m'><pose>3 0 0 0 0 0</pose>" + kBox +
               "</model>\n<model name='n'><link name='l'>" + kVisual + kVisual +
               "</link><joint name='j' type='fixed'><parent>l</parent><child>none</child></joint>"
               "</model>"));
  EXPECT_THAT(names(loaded.world), ElementsAre("m/l/v", "m_2/l/v", "n/l/v", "n/l/v_2"));
  EXPECT_THAT(loaded.warnings, testing::Not(Contains(HasSubstr("Failed to load"))));
  EXPECT_THAT(loaded.warnings,
              Contains("w.world: line 4: <model> has the name \"m\" of another: it is called \"m_2\""));
  EXPECT_EQ(loaded.summary(), "4 of 4 visuals");
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

}  // namespace
}  // namespace vismem
