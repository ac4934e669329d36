#include "evaluation/figures/board.h"

#include <gtest/gtest.h>

#include "evaluation/floor_view.h"
#include "support/picture_probe.h"

namespace vismem {
namespace {

TEST(PlanOfScore, ColoursRightFalseUnconfirmedAndMissedEdges) {
  FloorTruth truth(mapOf({{{-0.4, 0.1}, {0.4, 0.1}}, {{-0.4, -0.3}, {0.4, -0.3}}}));
  truth.addView(camera(), lookingDown(), kNothingInTheWay, 10.0);
  const std::vector<RememberedEdge> memory{remembered({{-0.4, 0.1}, {0.4, 0.1}}),
                                           remembered({{0.0, 0.3}, {0.4, 0.4}}),
                                           remembered({{-0.4, 0.2}, {-0.2, 0.4}}, false)};
  const Plan plan = planOfScore(scoreMemory(memory, truth.edges()), memory, truth.edges());
  const auto legend = legendOfScore();
  const auto colourOf = [&](const Segment2& world) {
    // The last line drawn at this place.
    for (auto line = plan.lines.rbegin(); line != plan.lines.rend(); ++line) {
      if ((line->world.a - world.a).norm() < 1e-9 && (line->world.b - world.b).norm() < 1e-9) return *line;
    }
    return PlanLine{};
  };
  const auto named = [&](const std::string& text) {
    for (const LegendEntry& entry : legend) {
      if (entry.text.find(text) != std::string::npos) return entry.color;
    }
    ADD_FAILURE() << "no legend entry with " << text;
    return Rgb{};
  };
  EXPECT_EQ(colourOf(memory[0].world).color, named("right"));
  EXPECT_EQ(colourOf(memory[1].world).color, named("false"));
  EXPECT_TRUE(colourOf(memory[2].world).dashed);
  EXPECT_EQ(colourOf({{-0.4, -0.3}, {0.4, -0.3}}).color, named("not remembered"));
}

TEST(Board, PutsPicturesAndPlansSideBySide) {
  BoardPanel picture{"picture", {}, cv::Mat(60, 100, CV_8UC3, cv::Scalar(10, 200, 10)), {}};
  Plan plan;
  plan.low = {-1.0, -1.0};
  plan.high = {1.0, 1.0};
  plan.lines.push_back({{{-1.0, 0.0}, {1.0, 0.0}}, colors::kLost, 4.0, false});
  BoardPanel floor{"plan", {"caption"}, {}, plan};
  const cv::Mat one = drawBoard({"title", "", {{picture}}, {}}, 200);
  const cv::Mat two = drawBoard({"title", "", {{picture, floor}}, {}}, 200);
  EXPECT_GT(two.cols, one.cols + 190);
  int green = 0;
  int red = 0;
  for (int v = 0; v < two.rows; ++v) {
    for (int u = 0; u < two.cols; ++u) {
      const auto& p = two.at<cv::Vec3b>(v, u);
      green += u < one.cols && p[0] < 60 && p[1] > 150 && p[2] < 60;
      red += u > one.cols && p[0] > 150 && p[1] < 100;
    }
  }
  EXPECT_NEAR(green, 200 * 120, 1500) << "the picture, enlarged to the panel";
  EXPECT_GT(red, 200 * 3) << "the plan's line across its panel";
}

constexpr Rgb kRed{220, 20, 20};

int countOf(const cv::Mat& picture, Rgb color) {
  int count = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& p = picture.at<cv::Vec3b>(y, x);
      count +=
          std::abs(p[0] - color.r) < 12 && std::abs(p[1] - color.g) < 12 && std::abs(p[2] - color.b) < 12;
    }
  }
  return count;
}

/// Darkest pixels of a plan of one line.
int inkOf(const std::string& name, double length_m) {
  Plan plan;
  plan.low = {-1.0, -1.0};
  plan.high = {1.0, 1.0};
  plan.lines.push_back({{{0.0, 0.05}, {length_m, 0.05}}, kRed, 2.0, false, name});
  BoardPanel panel;
  panel.plan = plan;
  return countOf(drawBoard({"", "", {{panel}}, {}}, 400), colors::kInk);
}

TEST(Board, NamesTheLinesThatAreLongEnough) {
  EXPECT_EQ(inkOf("", 0.8), 0);
  EXPECT_GT(inkOf("2300", 0.8), 20);
  EXPECT_EQ(inkOf("2300", 0.05), 0);
}

TEST(Board, NumbersTheGridOfAPlan) {
  Plan plan;
  plan.low = {-1.0, -1.0};
  plan.high = {1.0, 1.0};
  BoardPanel panel;
  panel.plan = plan;
  EXPECT_GT(countOf(drawBoard({"", "", {{panel}}, {}}, 400), colors::kFaintInk), 100);
}

/// Two rows of a picture with a segment and one without.
Board segments() {
  const cv::Mat black(60, 80, CV_8UC3, cv::Scalar::all(0));
  BoardPanel with{"with", {"one segment"}, black, {}};
  with.segments = {{{{10, 30}, {70, 30}}, kRed}};
  const BoardPanel without{"without", {"none", "a second line"}, black, {}};
  return {"title", "subtitle", {{with, without}, {with, without}}, {}, {"first row", "second row"}};
}

TEST(Board, DrawsEachSegmentInItsPanelOnly) {
  const cv::Mat picture = drawBoard(segments(), 160);
  ASSERT_EQ(picture.type(), CV_8UC3);
  // Margins of 18, two panels of 160 and 18 between them.
  ASSERT_EQ(picture.cols, 18 + 160 + 18 + 160 + 18);
  EXPECT_GT(countOf(picture.colRange(18, 178), kRed), 2 * 100);  // twice 60 px of image at twice the size
  EXPECT_EQ(countOf(picture.colRange(196, picture.cols), kRed), 0);
  Board untitled = segments();
  untitled.row_titles.clear();
  EXPECT_EQ(drawBoard(untitled, 160).rows, picture.rows - 2 * 24) << "a line above each row";
}

TEST(Board, KeepsSegmentsThatLeaveTheImageInsideTheirPanel) {
  Board far = segments();
  far.rows[0][0].segments = {{{{-500, 30}, {900, 30}}, kRed}};
  far.rows[1][0].segments.clear();
  const cv::Mat picture = drawBoard(far, 160);
  EXPECT_GT(countOf(picture.colRange(18, 178), kRed), 100);
  EXPECT_EQ(countOf(picture.colRange(0, 17), kRed) + countOf(picture.colRange(180, picture.cols), kRed), 0);
}

TEST(Board, WrapsALegendThatIsTooLong) {
  Board many = segments();
  many.legend = {{"a label", kRed}};
  const int rows = drawBoard(many, 160).rows;
  many.legend.assign(12, {"a label of some length", kRed});
  EXPECT_GE(drawBoard(many, 160).rows, rows + 2 * 17);
}

}  // namespace
}  // namespace vismem
