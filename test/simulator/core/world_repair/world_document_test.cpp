// Removal of the elements of a world that a reader rejects, with a reader that rejects the word "bad".
#include "simulator/core/world_repair/world_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string refuseBad(const std::string& xml) {
  return xml.find("bad") == std::string::npos ? "" : "it is bad";
}
std::string world(const std::string& content) {
  return "<sdf version='1.6'><world name='w'>\n" + content + "</world></sdf>";
}
std::string problemOf(const std::string& xml) {
  try {
    const WorldDocument document(xml, "w.world");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(WorldDocument, NamesFileAndLineOfATextThatIsNoWorld) {
  EXPECT_EQ(problemOf("<sdf>\n<world></sdf>"),
            "w.world:2: not XML: mismatched element (must be a world in SDF)");
  EXPECT_EQ(problemOf("\n<svg/>"), "w.world:2: begins with the element <svg> (must be a world in SDF)");
  EXPECT_EQ(problemOf("<gazebo/>"), "no error") << "the older name";
}

TEST(WorldDocument, OnlyTheRejectedVisualGoes) {
  WorldDocument document(
      world("<model name='a'><link name='l'><visual name='v'/>\n<visual name='bad'/></link></model>"
            "<model name='b'><link name='l'><visual name='v'/></link></model>"),
      "w.world");
  std::vector<LostInclude> lost;
  EXPECT_THAT(document.takeOutRefused(refuseBad, 100, lost),
              ElementsAre("line 3: <visual name=\"bad\"> of <model name=\"a\"> is left out: it is bad"));
  EXPECT_THAT(lost, IsEmpty());
  EXPECT_EQ(document.visualsLost(), 1);
  EXPECT_EQ(
      document.text(),
      "<sdf version=\"1.6\"><world name=\"w\"><model name=\"a\"><link name=\"l\"><visual name=\"v\"/></link>"
      "</model><model name=\"b\"><link name=\"l\"><visual name=\"v\"/></link></model></world></sdf>");
}

TEST(WorldDocument, WithoutItsPoseOrShapeAnElementGoesAsAWhole) {
  WorldDocument document(
      world("<model name='a'><pose>bad</pose><link name='l'><visual name='v'/><visual name='u'/>"
            "</link></model><model name='b'/>"),
      "w.world");
  std::vector<LostInclude> lost;
  EXPECT_THAT(document.takeOutRefused(refuseBad, 100, lost),
              ElementsAre("line 2: <model name=\"a\"> is left out: it is bad"));
  EXPECT_EQ(document.visualsLost(), 2);
  EXPECT_THAT(document.text(), HasSubstr("<world name=\"w\"><model name=\"b\"/></world>"));
}

TEST(WorldDocument, IncludesAreHandedOutToBeReadByThemselves) {
  WorldDocument document(
      world("<include><uri>model://x</uri><name>n</name><pose>1 0 0 0 0 0</pose></include>\n"
            "<include><uri>model://bad</uri><light/></include><model name='bad'/>"),
      "w.world");
  std::vector<LostInclude> lost;
  EXPECT_EQ(document.takeOutRefused(refuseBad, 100, lost).size(), 1U);
  ASSERT_EQ(lost.size(), 2U);
  EXPECT_EQ(lost[0].uri, "model://x");
  EXPECT_EQ(lost[0].name, "n");
  EXPECT_EQ(lost[0].pose, "1 0 0 0 0 0");
  EXPECT_EQ(lost[1].description, "line 3: <include> of model://bad");
  EXPECT_THAT(document.text(), Not(HasSubstr("include")));
}

TEST(WorldDocument, EndsAfterItsTries) {
  std::string models;
  for (int i = 0; i < 50; ++i) models += "<model name='bad" + std::to_string(i) + "'/>";
  WorldDocument document(world(models), "w.world");
  std::vector<LostInclude> lost;
  EXPECT_THAT(document.takeOutRefused(refuseBad, 20, lost).back(), HasSubstr("too much of it is wrong"));
}

TEST(WorldDocument, RepairsAndLeavesOutWhatHasNoPlace) {
  WorldDocument document(
      "<sdf><world name='w'><model name='a'><pose>1 2</pose></model>"
      "<model name='b'><pose>nan 0 0 0 0 0</pose></model></world></sdf>",
      "w.world");
  EXPECT_THAT(
      document.repair(),
      ElementsAre("line 1: a number of <pose> is not finite", "line 1: no version of SDF: 1.6 is assumed",
                  "line 1: <model name=\"a\"> is left out: its <pose> \"1 2\" cannot be read (must be 6 "
                  "numbers: x y z roll pitch yaw)"));
  EXPECT_EQ(document.text(),
            "<sdf version=\"1.6\"><world name=\"w\"><model name=\"b\"><pose>1e300 0 0 0 0 "
            "0</pose></model></world></sdf>");
}

TEST(WorldDocument, AModelAloneGetsAWorld) {
  WorldDocument document("<sdf version='1.6'><model name='m'/></sdf>", "m.sdf");
  document.wrapModel();
  EXPECT_EQ(document.text(), "<sdf version=\"1.6\"><world name=\"one\"><model name=\"m\"/></world></sdf>");
}

}  // namespace
}  // namespace vismem
