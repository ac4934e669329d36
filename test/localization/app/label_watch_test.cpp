// Tests C3: a map whose labels are not those of the visual memory is named.
#include "localization/app/label_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace vismem {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

SegmentMap mapOf(const std::vector<Label>& labels) {
  SegmentMap map;
  for (const Label& label : labels) map.segments.push_back({Segment3{{0, 0, 0}, {1, 0, 0}}, label});
  return map;
}

MemorySnapshot memoryOf(double t_s, const std::vector<Label>& labels) {
  MemorySnapshot memory;
  memory.stamp_us = toStampUs(t_s);
  for (const Label& label : labels) {
    memory.segments.emplace_back();
    memory.segments.back().label = label;
  }
  return memory;
}

const std::vector<Label> kField(5, "field_line");

TEST(LabelWatch, NamesTheLabelsOfBothAfterAWhile) {
  LabelWatch watch(mapOf({"skirting", "door"}));
  EXPECT_THAT(watch.update(memoryOf(0.0, kField)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(9.9, kField)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(10.0, kField)),
              AllOf(HasSubstr("no label of the visual memory (field_line) is on the map (door, skirting)"),
                    HasSubstr("Localization.Map")));
}

TEST(LabelWatch, CountsFromTheFirstSufficientMemoryOfAnEpoch) {
  LabelWatch watch(mapOf({"skirting"}));
  EXPECT_THAT(watch.update(memoryOf(100.0, kField)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(0.0, kField)), IsEmpty()) << "the source began anew";
  EXPECT_THAT(watch.update(memoryOf(9.0, kField)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(9.5, {"field_line"})), IsEmpty()) << "too little to judge";
  EXPECT_THAT(watch.update(memoryOf(11.0, kField)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(21.0, kField)), HasSubstr("field_line"));
}

TEST(LabelWatch, TakesOneLabelOfTheMapForAMemoryOfThePlace) {
  LabelWatch watch(mapOf({"skirting"}));
  EXPECT_THAT(watch.update(memoryOf(0.0, kField)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(20.0, kField)), HasSubstr("field_line"));
  std::vector<Label> seen = kField;
  seen.push_back("skirting");
  EXPECT_THAT(watch.update(memoryOf(21.0, seen)), IsEmpty());
  EXPECT_THAT(watch.update(memoryOf(60.0, kField)), IsEmpty()) << "something that the map lacks";
}

TEST(LabelWatch, LeavesUnknownLabelsAndAMapThatFitsEveryLabelAlone) {
  LabelWatch unlabelled(mapOf({"skirting"}));
  LabelWatch any(mapOf({"any"}));
  for (const double t_s : {0.0, 20.0}) {
    EXPECT_THAT(unlabelled.update(memoryOf(t_s, std::vector<Label>(9, kUnknownLabel))), IsEmpty());
    EXPECT_THAT(any.update(memoryOf(t_s, kField)), IsEmpty());
  }
}

}  // namespace
}  // namespace vismem
