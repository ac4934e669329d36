#include "calibration/core/body/setup_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "calibration/core/body/body_keys.h"

namespace vismem {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(SetKeys, ChangesValuesInPlaceAndKeepsEverythingElse) {
  const std::string text = "# A robot.\nA.Mount.X_m = 1 2 3  # measured by hand\n\nA.Other = yes\n";
  const EditedText edited = setKeys(text, {{"A.Mount.X_m", "4 5 6"}, {"A.Other", "yes"}});
  EXPECT_EQ(edited.text, "# A robot.\nA.Mount.X_m = 4 5 6  # measured by hand\n\nA.Other = yes\n");
  EXPECT_THAT(edited.diff, ElementsAre("-2: A.Mount.X_m = 1 2 3  # measured by hand",
                                       "+2: A.Mount.X_m = 4 5 6  # measured by hand"));
}

TEST(SetKeys, AddsNewKeysBesideTheirGroup) {
  const std::string text = "A.Mount.X = 1\nA.Gaze.Y = 2\nIce.Z = 3\n";
  EXPECT_EQ(setKeys(text, {{"A.Mount.W", "5"}}).text,
            "A.Mount.X = 1\nA.Mount.W = 5\nA.Gaze.Y = 2\nIce.Z = 3\n");
  EXPECT_EQ(setKeys(text, {{"A.New.V", "6"}}).text, "A.Mount.X = 1\nA.Gaze.Y = 2\nA.New.V = 6\nIce.Z = 3\n");
  EXPECT_EQ(setKeys("", {{"A.New.V", "6"}}).text, "A.New.V = 6\n");
}

TEST(SetKeys, DoesNotTakeACommentForAKey) {
  const EditedText edited = setKeys("#A.X = 1\nA.Y = 2\n", {{"A.X", "3"}});
  EXPECT_EQ(edited.text, "#A.X = 1\nA.Y = 2\nA.X = 3\n");
}

TEST(SetKeys, HasNoDiffWithoutAChange) {
  EXPECT_TRUE(setKeys("A.X = 3\n", {{"A.X", "3"}}).diff.empty());
}

/// Everything observable with a deviation of 1e-4, but for some.
BodyEstimate estimateWithout(const std::vector<std::size_t>& unknown,
                             const std::vector<std::size_t>& places) {
  BodyEstimate estimate;
  CameraMount mount;
  mount.T_robot_pantilt = poseFromXyzRpy(0.11, 0.02, 0.43, 0.01, 0.02, 0.03);
  estimate.parameters = nominalBody(mount, {}, 0.35);
  for (std::size_t i = 0; i < kParameterCount; ++i) {
    const bool is_unknown = std::find(unknown.begin(), unknown.end(), i) != unknown.end();
    estimate.rows.push_back({i, 1.0, is_unknown ? std::nullopt : std::optional(1e-4)});
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const bool is_unknown = std::find(places.begin(), places.end(), i) != places.end();
    estimate.place[i] = {i, 0.0, is_unknown ? std::nullopt : std::optional(1e-4)};
  }
  return estimate;
}

TEST(BodyKeys, ListsWhatIsObservable) {
  const auto keys = bodyKeys(estimateWithout({}, {}), {}, 0.33);
  EXPECT_EQ(keys.size(), 13U);
  EXPECT_THAT(keys,
              Contains(KeyValue("ActiveVisualMemory.Mount.PanTilt.Position_m", "0.1100 0.0200 0.4300")));
  EXPECT_THAT(keys, Contains(KeyValue("ActiveVisualMemory.Mount.PanTilt.Rotation_deg", "0.573 1.146 1.719")));
  EXPECT_THAT(keys, Contains(KeyValue("ActiveVisualMemory.Wheels.Base_m", "0.35000")));
}

TEST(BodyKeys, NeverWritesANumberThatIsNotObservable) {
  for (const auto& [key, value] :
       bodyKeys(estimateWithout({wheelParameter(kBase), kJointDelay}, {0, 1, 5}), {}, 0.33)) {
    EXPECT_THAT(key, testing::Not(testing::AnyOf(HasSubstr("Wheels.Base"), HasSubstr("Wheels.Left"),
                                                 HasSubstr("Joints.Delay"))));
    if (key == "ActiveVisualMemory.Mount.PanTilt.Position_m") {
      EXPECT_EQ(value, "0.0000 0.0000 0.4300") << "x and y as described";
    }
    if (key == "ActiveVisualMemory.Mount.PanTilt.Rotation_deg") {
      EXPECT_EQ(value, "0.573 1.146 0.000");
    }
  }
  for (const auto& [key, value] : bodyKeys(estimateWithout({}, {2}), {}, 0.33)) {
    EXPECT_THAT(key, testing::Not(HasSubstr("Mount"))) << "no height, no mounting";
  }
}

}  // namespace
}  // namespace vismem
