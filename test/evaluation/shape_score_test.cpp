// Tests M8, M9. Remembered shapes against true ones.
#include "evaluation/core/shape_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::HasSubstr;

const std::string kHeader =
    "kind,name,on,width_m,outer_radius_m,inner_radius_m,x1_m,y1_m,x2_m,y2_m,x3_m,y3_m,x4_m,y4_m\n";
const std::string kFloor = kHeader +
                           "# what is there\n"
                           "parallelogram,square,marking,,,,0.1,0.1,0.4,0.1,0.4,0.4,0.1,0.4\n"
                           "arrow,arrow,marking,0.05,,,-0.3,0,-0.1,0,-0.2,0.1,-0.2,-0.1\n"
                           "circle,circle,marking,,0.2,0.15,0.2,-0.25,,,,,,\n"
                           "parallelogram,line,stripe,0.05,,,-0.4,-0.4,-0.35,-0.4,-0.35,0.3,-0.4,0.3\n";

std::vector<TrueShape> shapes() {
  return parseTrueShapes(kFloor, "floor.csv");
}

/// 1 m above the origin, looking straight down on 1.15 m.
ShapeTruth seen(const SeesFloor& sees) {
  ShapeTruth truth(shapes());
  Pose3 pose = Pose3::Identity();
  pose.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  pose.translation() << 0.0, 0.0, 1.0;
  truth.addView(intrinsicsFromFieldOfView(240, 240, std::numbers::pi / 3.0), pose, sees);
  return truth;
}

const SeesFloor kAll = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return true; };

Primitive polygon(PrimitiveKind kind, const std::vector<Eigen::Vector2d>& vertices) {
  Primitive p;
  p.kind = kind;
  p.vertices.assign(vertices.begin(), vertices.end());
  for (const auto& v : p.vertices) p.centre += v / static_cast<double>(p.vertices.size());
  return p;
}

Primitive circle(const Eigen::Vector2d& centre, double radius) {
  Primitive p;
  p.kind = PrimitiveKind::kCircle;
  p.centre = centre;
  p.radius_m = radius;
  return p;
}

TEST(TrueShapes, AreReadAsPrimitivesAreMade) {
  const auto all = shapes();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[1].vertices[0], Eigen::Vector2d(-0.1, 0.0)) << "the tip comes first";
  EXPECT_EQ(all[2].outer_radius_m, 0.2);
  ASSERT_EQ(all[3].kind, PrimitiveKind::kStripe);
  EXPECT_TRUE(all[3].vertices[0].isApprox(Eigen::Vector2d(-0.375, -0.4)));
  EXPECT_TRUE(all[3].vertices[1].isApprox(Eigen::Vector2d(-0.375, 0.3)));
}

TEST(TrueShapes, WhatIsWrongIsNamedWithItsLine) {
  const auto problemOf = [](const std::string& text) {
    try {
      parseTrueShapes(text, "floor.csv");
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(problemOf("kind,name\n"), HasSubstr("floor.csv:1"));
  EXPECT_THAT(problemOf(kHeader + "square,a,marking,,,,0,0,0,0,0,0,0,0\n"),
              HasSubstr("floor.csv:2: kind \"square\""));
  EXPECT_THAT(problemOf(kHeader + "triangle,a,marking,,,,0,0,1,x,0,1,,\n"),
              HasSubstr("point 2 of a triangle"));
  EXPECT_THAT(problemOf(kHeader + "circle,a,marking,,0.1,0.2,0,0,,,,,,\n"), HasSubstr("outer > inner"));
  EXPECT_THAT(problemOf(kHeader + "circle,a\n"), HasSubstr("expected 14"));
  EXPECT_THAT(problemOf(kHeader), HasSubstr("no shapes"));
}

TEST(ShapeTruth, KnowsWhatWasSeenOfAnOutlineAndItsCorners) {
  const ShapeTruth whole = seen(kAll);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(whole.seenShare(i), 1.0) << i;
  // Something stands on the corner (0.4, 0.4) of the square.
  const ShapeTruth covered = seen([](const Eigen::Vector3d&, const Eigen::Vector3d& p) {
    return (p.head<2>() - Eigen::Vector2d(0.4, 0.4)).norm() > 0.1;
  });
  EXPECT_NEAR(covered.seenShare(0), 1.0 - 0.2 / 1.2, 0.03);
  EXPECT_FALSE(covered.seenCorner(0, 2));
  EXPECT_TRUE(covered.seenCorner(0, 1));
}

TEST(ShapeScore, GivesEachTrueShapeToTheNearestOne) {
  const ShapeTruth truth = seen(kAll);
  const auto judged = judgeShapes(
      {
          // The corners in another order, 1 cm off; and a copy that is 4 cm off.
          polygon(PrimitiveKind::kParallelogram, {{0.41, 0.4}, {0.11, 0.4}, {0.11, 0.1}, {0.41, 0.1}}),
          polygon(PrimitiveKind::kParallelogram, {{0.14, 0.1}, {0.44, 0.1}, {0.44, 0.4}, {0.14, 0.4}}),
          // An arrow that points the other way is another one.
          polygon(PrimitiveKind::kArrow, {{-0.3, 0.0}, {-0.1, 0.0}, {-0.2, -0.1}, {-0.2, 0.1}}),
          polygon(PrimitiveKind::kArrow, {{-0.1, 0.0}, {-0.3, 0.0}, {-0.2, 0.1}, {-0.2, -0.1}}),
          circle({0.2, -0.25}, 0.175),
          circle({0.2, -0.25}, 0.27),
          circle({0.4, -0.25}, 0.175),
          polygon(PrimitiveKind::kTriangle, {{0.1, 0.1}, {0.4, 0.1}, {0.4, 0.4}}),
      },
      truth, {});
  ASSERT_EQ(judged.size(), 8u);
  EXPECT_EQ(judged[0].true_shape, 0);
  EXPECT_NEAR(judged[0].error_m, 0.01, 1e-9);
  EXPECT_EQ(judged[1].true_shape, -1);
  EXPECT_EQ(judged[2].true_shape, -1);
  EXPECT_EQ(judged[3].true_shape, 1);
  EXPECT_EQ(judged[4].true_shape, 2);
  EXPECT_EQ(judged[5].true_shape, -1);
  EXPECT_EQ(judged[6].true_shape, -1);
  EXPECT_EQ(judged[7].true_shape, -1);
}

TEST(ShapeScore, OneCornerThatIsTooFarOffMakesItFalse) {
  const ShapeTruth truth = seen(kAll);
  // 10 cm and a pixel: (1^2 + 1^2) / (1 * 207.8) is 1 cm, for a camera 1 m up that looks at a place 1 m off.
  const auto with = [&](double off) {
    return judgeShapes({polygon(PrimitiveKind::kParallelogram,
                                {{0.1, 0.1}, {0.4, 0.1}, {0.4 + off, 0.4}, {0.1, 0.4}})},
                       truth, {})
        .front()
        .true_shape;
  };
  EXPECT_EQ(with(0.09), 0);
  EXPECT_EQ(with(0.12), -1);
}

TEST(ShapeScore, ShapesArePutWhereTheRobotReallyIs) {
  MemorySnapshot memory;
  memory.T_odom_robot = {5.0, 5.0, 0.0};
  memory.primitives = {polygon(PrimitiveKind::kTriangle, {{6.0, 5.0}, {7.0, 5.0}, {6.0, 6.0}})};
  const auto world = shapesIn(memory, {1.0, 0.0, 0.5 * std::numbers::pi});
  EXPECT_TRUE(world[0].vertices[0].isApprox(Eigen::Vector2d(1.0, 1.0), 1e-9));
  EXPECT_TRUE(world[0].vertices[2].isApprox(Eigen::Vector2d(0.0, 1.0), 1e-9));
}

}  // namespace
}  // namespace vismem
