// Texts that Gazebo's old parser accepted, as XML.
#include "simulator/core/world_repair/text_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(TextRepair, KeepsAWellFormedTextByteByByte) {
  const std::string xml =
      "<?xml version='1.0'?>\n<!-- a=b <c d=e> --><sdf version=\"1.6\">\n<![CDATA[<x y=z>]]><a b = "
      "'c=d'/>\xC3\xA9</sdf>";
  const WorldText text = repairWorldText(xml);
  EXPECT_EQ(text.xml, xml);
  EXPECT_THAT(text.notes, IsEmpty());
}

TEST(TextRepair, QuotesBareValuesAndNamesTheFirstThree) {
  const WorldText text = repairWorldText("<gui fullscreen=1><a b=2/><c d= 3 e='4' f=5></gui>");
  EXPECT_EQ(text.xml, "<gui fullscreen=\"1\"><a b=\"2\"/><c d= \"3\" e='4' f=\"5\"></gui>");
  EXPECT_THAT(text.notes,
              ElementsAre("is not well-formed XML: 4 attribute value(s) without quotes, such as 1 2 3"));
}

TEST(TextRepair, ReadsLatin1AndDropsAByteOrderMark) {
  EXPECT_EQ(repairWorldText("\xEF\xBB\xBF<a/>").xml, "<a/>");
  const WorldText text = repairWorldText("<a name='caf\xE9'/>");
  EXPECT_EQ(text.xml, "<a name='caf\xC3\xA9'/>");
  EXPECT_THAT(text.notes, ElementsAre("is not UTF-8: read as Latin-1"));
  // An overlong sequence of two bytes is no UTF-8 either.
  EXPECT_EQ(repairWorldText("<a>\xC0\x80</a>").notes.size(), 1U);
}

TEST(TextRepair, RefusesBytesThatAreNoText) {
  const WorldText text = repairWorldText(std::string("<a>\0</a>", 8));
  EXPECT_EQ(text.xml, "");
  EXPECT_THAT(text.notes, ElementsAre("is not text in UTF-8 (it holds zero bytes)"));
}

TEST(TextRepair, LeavesUnfinishedTextsToTheParser) {
  for (const char* xml : {"", "<", "<a b=", "<a b='c", "<!-- a", "<![CDATA[", "<a <b c='1'>", "text"}) {
    EXPECT_EQ(repairWorldText(xml).xml, xml);
  }
}

TEST(TextRepair, SkipsWhatIsNoElement) {
  const std::string xml = "<!--x--><a/><?y?><![CDATA[z]]><!D>";
  EXPECT_EQ(skipNonElement(xml, 0), 8U);
  EXPECT_EQ(skipNonElement(xml, 8), 8U) << "an element";
  EXPECT_EQ(skipNonElement(xml, 12), 17U);
  EXPECT_EQ(skipNonElement(xml, 17), 30U);
  EXPECT_EQ(skipNonElement(xml, 30), 34U);
  EXPECT_EQ(skipNonElement("<!-- endless", 0), 12U);
}

}  // namespace
}  // namespace vismem
