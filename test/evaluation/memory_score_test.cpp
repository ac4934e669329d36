// Tests E1, E4.
#include "evaluation/core/memory_score.h"

#include <gtest/gtest.h>

#include "evaluation/floor_view.h"

namespace vismem {
namespace {

class OneEdge : public testing::Test {
 protected:
  OneEdge() : truth(mapOf({{{-0.4, 0.1}, {0.4, 0.1}}})) {
    truth.addView(camera(), lookingDown(), kNothingInTheWay, 10.0);
  }
  FloorTruth truth;
};

TEST_F(OneEdge, IsRightWithinFiveCentimetresAndThreeDegrees) {
  using V = MemoryScore::Verdict;
  const auto verdict = [&](Segment2 s) {
    return scoreMemory({remembered(s)}, truth.edges()).judged[0].verdict;
  };
  EXPECT_EQ(verdict({{-0.4, 0.1}, {0.4, 0.1}}), V::kRight);
  EXPECT_EQ(verdict({{0.4, 0.1}, {-0.4, 0.1}}), V::kRight) << "its direction does not matter";
  EXPECT_EQ(verdict({{-0.44, 0.12}, {0.37, 0.12}}), V::kRight);
  EXPECT_EQ(verdict({{-0.4, 0.1}, {0.2, 0.1}}), V::kPartial) << "20 cm are missing";
  EXPECT_EQ(verdict({{-0.4, 0.1}, {0.55, 0.1}}), V::kPartial) << "15 cm too long";
  EXPECT_EQ(verdict({{-0.4, 0.2}, {0.4, 0.2}}), V::kFalse);
  EXPECT_EQ(verdict({{-0.4, 0.075}, {0.4, 0.125}}), V::kFalse) << "3.6 degrees";
}

TEST_F(OneEdge, CountsDuplicatesMissesAndWhatIsNotConfirmed) {
  auto score =
      scoreMemory({remembered({{-0.4, 0.1}, {0.4, 0.1}}), remembered({{-0.4, 0.12}, {0.4, 0.12}}),
                   remembered({{-0.4, 0.1}, {0.4, 0.1}}, false), remembered({{2, 2}, {3, 3}}, false)},
                  truth.edges());
  EXPECT_EQ(score.right, 2);
  EXPECT_DOUBLE_EQ(score.duplicates(), 2.0);
  EXPECT_DOUBLE_EQ(score.recall(), 1.0);
  EXPECT_EQ(score.unconfirmed, 2);
  EXPECT_EQ(score.unconfirmed_on_edges, 1);
  score = scoreMemory({}, truth.edges());
  EXPECT_DOUBLE_EQ(score.recall(), 0.0);
  EXPECT_EQ(score.missed, std::vector<int>{0});
}

TEST(MemoryScore, TwoEdgesBesideEachOtherNeedTwoElements) {
  FloorTruth truth(mapOf({{{-0.4, 0.00}, {0.4, 0.00}}, {{-0.4, 0.05}, {0.4, 0.05}}}));
  truth.addView(camera(), lookingDown(), kNothingInTheWay, 10.0);
  auto score = scoreMemory({remembered({{-0.4, 0.025}, {0.4, 0.025}})}, truth.edges());
  EXPECT_EQ(score.found, 1);
  score = scoreMemory({remembered({{-0.4, 0.02}, {0.4, 0.02}}), remembered({{-0.4, 0.03}, {0.4, 0.03}})},
                      truth.edges());
  EXPECT_EQ(score.found, 2);
  EXPECT_DOUBLE_EQ(score.duplicates(), 1.0);
}

}  // namespace
}  // namespace vismem
