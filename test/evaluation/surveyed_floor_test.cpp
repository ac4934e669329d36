// Tests E1.
#include "evaluation/core/surveyed_floor.h"

#include <gmock/gmock.h>

#include "common/config/config_error.h"
#include "evaluation/floor_view.h"

namespace vismem {
namespace {

const Eigen::Vector3d kEye{0.0, 0.0, 1.0};

TEST(Boxes, HideWhatIsBehindThemAndNotWhereTheyStand) {
  const std::vector<Segment3> crate{{{2.0, -0.5, 0.0}, {1.0, 0.5, 0.4}}};
  EXPECT_FALSE(isHidden(kEye, {0.8, 0.0, 0.0}, crate));
  EXPECT_FALSE(isHidden(kEye, {1.0, 0.0, 0.0}, crate)) << "the foot of its front";
  EXPECT_TRUE(isHidden(kEye, {2.2, 0.0, 0.0}, crate));
  EXPECT_FALSE(isHidden(kEye, {4.0, 0.0, 0.0}, crate)) << "the ray passes above it";
  EXPECT_FALSE(isHidden(kEye, {2.2, 1.6, 0.0}, crate)) << "the ray passes beside it";
  EXPECT_FALSE(isHidden(kEye, {0.0, 0.0, 0.0}, crate)) << "straight down";
}

TEST(SurveyRows, MayBeNamed) {
  const auto rows = parseSurvey("x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,name\n# walls\n2,0.5,1,1,-0.5,0,crate\n\n0,0,0,1,1,1\n", "o.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].a, Eigen::Vector3d(2.0, 0.5, 1.0));
  EXPECT_EQ(rows[0].b, Eigen::Vector3d(1.0, -0.5, 0.0));
}

TEST(SurveyRows, NameEachWrongLine) {
  try {
    parseSurvey("x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,name\n1,2,3,4,5\n1,2,3,4,5,nan,box\n", "o.csv");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("o.csv:2: \"1,2,3,4,5\""), testing::HasSubstr("o.csv:3: ")));
  }
}

class SurveyOfTwoEdges : public testing::Test {
 protected:
  SurveyOfTwoEdges() : floor(mapOf({{{-0.4, 0.1}, {0.4, 0.1}}, {{-0.4, -0.3}, {0.4, -0.3}}}), joints, crate) {
    floor.addView(camera(), lookingDown());
  }
  const std::vector<Segment3> joints{{{-0.4, 0.3, 0.0}, {0.4, 0.3, 0.0}}};
  const std::vector<Segment3> crate{{{-0.5, -0.25, 0.0}, {0.5, -0.2, 0.5}}};  // between the camera and the second edge
  SurveyedFloor floor;
};

TEST_F(SurveyOfTwoEdges, LeavesOutWhatABoxHidesAndWhatLiesOnANeutralEdge) {
  SurveyScore score = floor.score({remembered({{-0.4, 0.1}, {0.4, 0.1}}), remembered({{-0.3, 0.31}, {0.2, 0.31}})});
  EXPECT_EQ(score.shown, 1);
  EXPECT_DOUBLE_EQ(score.recall(), 1.0);
  EXPECT_EQ(score.judged, 1);
  EXPECT_DOUBLE_EQ(score.precision(), 1.0);
  score = floor.score({remembered({{-0.4, 0.12}, {0.4, 0.08}}), remembered({{0.1, 0.4}, {0.3, 0.2}})});
  EXPECT_EQ(score.judged, 2);
  EXPECT_DOUBLE_EQ(score.precision(), 0.5) << "a line across the joint is false";
  EXPECT_NEAR(score.line_rms_m, 0.02, 1e-9);
}

TEST_F(SurveyOfTwoEdges, OfAnEmptyMemoryHasNoRecall) {
  const SurveyScore score = floor.score({});
  EXPECT_DOUBLE_EQ(score.recall(), 0.0);
  EXPECT_DOUBLE_EQ(score.precision(), 0.0);
}

}  // namespace
}  // namespace vismem
