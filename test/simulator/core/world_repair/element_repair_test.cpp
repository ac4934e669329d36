// Values and names of single elements for which libsdformat rejects whole worlds.
#include "simulator/core/world_repair/element_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "simulator/core/world_repair/unsimulated.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class ElementRepair : public testing::Test {
 protected:
  tinyxml2::XMLElement& parse(const std::string& xml) {
    EXPECT_EQ(document_.Parse(xml.c_str()), tinyxml2::XML_SUCCESS);
    return *document_.RootElement();
  }
  std::string text() const {
    tinyxml2::XMLPrinter printer(nullptr, true);
    document_.Print(&printer);
    return printer.CStr();
  }
  std::vector<std::string> repair(const std::string& xml) {
    RepairNotes notes;
    repairElements(parse(xml), notes);
    return notes.take();
  }

 private:
  tinyxml2::XMLDocument document_;
};

TEST_F(ElementRepair, NumbersThatAreNotFiniteBecomeOutOfRange) {
  EXPECT_THAT(
      repair("<link name='l'>\n<pose>nan 1 -Inf 0 0 0</pose><mass>+infinity</mass><mass>inf</mass></link>"),
      ElementsAre("line 2: a number of <mass> is not finite (2 times)",
                  "line 2: a number of <pose> is not finite"));
  EXPECT_EQ(text(),
            "<link name=\"l\"><pose>1e300 1 -1e300 0 0 0</pose><mass>1e300</mass><mass>1e300</mass></link>");
  EXPECT_THAT(repair("<uri>model://nan</uri>"), IsEmpty()) << "no list of numbers";
}

TEST_F(ElementRepair, ColoursAreClamped) {
  EXPECT_THAT(repair("<material><ambient>2 -1 0.5 1</ambient><diffuse>1 0 1 1</diffuse></material>"),
              ElementsAre("line 1: <ambient> is outside 0..1: the nearest colour is taken"));
  EXPECT_THAT(text(),
              testing::HasSubstr("<ambient>1.000000 0.000000 0.500000 1.000000</ambient><diffuse>1 0 1 1<"));
}

TEST_F(ElementRepair, EveryElementOfAKindHasANameOfItsOwn) {
  EXPECT_THAT(repair("<world name='w'><model name='a'/><model name='a'/><model name='a_2'/>\n<model/>"
                     "<light name='a'/></world>"),
              ElementsAre("line 1: <model> has the name \"a\" of another: it is called \"a_3\"",
                          "line 2: <model> has no name"));
  EXPECT_EQ(text(),
            "<world name=\"w\"><model name=\"a\"/><model name=\"a_3\"/><model name=\"a_2\"/>"
            "<model name=\"unnamed_model_2\"/><light name=\"a\"/></world>");
  EXPECT_THAT(repair("<plugin><model/><model/></plugin>"), testing::SizeIs(1))
      << "the root itself is repaired";
  EXPECT_THAT(repair("<world name='w'><plugin><model/></plugin></world>"), IsEmpty()) << "of others";
}

TEST_F(ElementRepair, AttributesOfSdf10BecomeElements) {
  modernizeElements(
      parse("<model name='m'><origin pose='1 2 3 0 0 0'/><link name='l'><visual><geometry>"
            "<mesh filename='a.dae' scale='1 1 1'/></geometry><material script='Gazebo/Red'/>"
            "</visual></link></model>"));
  EXPECT_EQ(
      text(),
      "<model name=\"m\"><pose>1 2 3 0 0 0</pose><link name=\"l\"><visual><geometry><mesh><uri>a.dae</uri>"
      "<scale>1 1 1</scale></mesh></geometry><material><script><name>Gazebo/Red</name></script></material>"
      "</visual></link></model>");
}

TEST_F(ElementRepair, PosesAreSixNumbersOrSevenWithAQuaternion) {
  const auto unreadable = [&](const std::string& pose) {
    return unreadablePose(parse("<link>" + pose + "</link>"));
  };
  EXPECT_EQ(unreadable(""), "");
  EXPECT_EQ(unreadable("<pose/>"), "");
  EXPECT_EQ(unreadable("<pose>0 0 1e400 +1 -2 .5</pose>"), "");
  EXPECT_EQ(unreadable("<pose rotation_format='quat_xyzw'>0 0 0 0 0 0 1</pose>"), "");
  EXPECT_EQ(unreadable("<pose>1 2</pose>"), "1 2");
  EXPECT_EQ(unreadable("<pose>0 0 0 0 0 0 1</pose>"), "0 0 0 0 0 0 1");
  EXPECT_EQ(unreadable("<pose>0 0 0 0 0 zero</pose>"), "0 0 0 0 0 zero");
}

TEST_F(ElementRepair, WhatIsNotSimulatedGoes) {
  removeUnsimulated(
      parse("<world><physics/><model name='m'><link name='l'><inertial/><visual/><sensor type='ray'/>"
            "<sensor type='camera'/></link><joint type='revolute'><axis/></joint></model>"
            "<state><model><pose/><link/></model></state></world>"));
  EXPECT_EQ(text(),
            "<world><model name=\"m\"><link name=\"l\"><visual/><sensor type=\"camera\"/></link>"
            "<joint type=\"fixed\"/></model><state><model><pose/></model></state></world>");
}

}  // namespace
}  // namespace vismem
