// Tests L12, B4.
#include "localization/core/map/visibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angles.h"
#include "localization/core/random_engine.h"
#include "localization/map_views.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const Label& label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

TEST(Visibility, OpaqueSegmentsOccludeOthersAndNotThemselves) {
  SegmentMap map;
  map.segments = {wall(2, -3, 2, 3), wall(3, -3, 3, 3), wall(1, -0.2, 1, 0.2, "marking")};
  const MapIndex index(map, {});
  const Visibility visible(index, std::vector<std::string>{"skirting", "*_foot"});
  std::vector<VisiblePoint> points;
  visible.around({0, 0, 0}, 5.0, {}, nullptr, points);
  double nearer = 0.0;
  double hidden = 0.0;
  double marking = 0.0;
  for (const VisiblePoint& point : points) {
    (point.p_robot.x() < 1.5 ? marking : point.p_robot.x() < 2.5 ? nearer : hidden) += point.length_m;
  }
  EXPECT_NEAR(marking, 0.4, 1e-9);
  EXPECT_NEAR(nearer, 6.0, 1e-9);  // a marking does not occlude the wall
  EXPECT_EQ(hidden, 0.0);
  // An obstacle 0.5 m ahead occludes a part of the wall and the marking.
  const std::vector<Segment2> obstacle{{{0.5, -0.1}, {0.5, 0.1}}};
  visible.around({0, 0, 0}, 5.0, obstacle, nullptr, points);
  for (const VisiblePoint& point : points) {
    EXPECT_GT(std::abs(std::atan2(point.p_robot.y(), point.p_robot.x())), degToRad(10));
  }
}

TEST(Visibility, AViewLimitsThePointsToTheImage) {
  SegmentMap map;
  map.segments = {wall(-3, 1, 3, 1)};
  const MapIndex index(map, {});
  const Visibility visible(index, std::vector<std::string>{});
  const ImageAnalysis view = test::emptyView(degToRad(90), degToRad(-20));
  const CameraView camera(view.intrinsics, view.T_robot_camera);
  std::vector<VisiblePoint> points;
  visible.around({0, 0, 0}, 5.0, {}, &camera, points);
  ASSERT_FALSE(points.empty());
  for (const VisiblePoint& point : points) {
    EXPECT_LT(std::abs(point.p_robot.x()), std::tan(degToRad(31)) * std::hypot(1.0, 0.45));
  }
}

/// A view limits the search for occluders, not the result.
TEST(VisibilityProperty, AViewGivesTheVisiblePointsInsideIt) {
  RandomEngine engine(23);
  SegmentMap map;
  for (int i = 0; i < 300; ++i) {
    const double x = uniform(engine, -10, 10);
    const double y = uniform(engine, -10, 10);
    const double length = uniform(engine, 0.1, 4.0);
    const double direction = uniform(engine, -3, 3);
    map.segments.push_back(wall(x, y, x + length * std::cos(direction), y + length * std::sin(direction),
                                i % 3 == 0 ? "marking" : "skirting"));
  }
  const MapIndex index(map, {});
  const Visibility visible(index, std::vector<std::string>{"skirting"});
  std::size_t shown = 0;
  std::size_t hidden = 0;
  for (int i = 0; i < 300; ++i) {
    const ImageAnalysis image = test::emptyView(uniform(engine, -3, 3), degToRad(uniform(engine, -90, 0)));
    const CameraView camera(image.intrinsics, image.T_robot_camera);
    const Pose2 pose{uniform(engine, -10, 10), uniform(engine, -10, 10), uniform(engine, -3, 3)};
    const std::vector<Segment2> obstacle{{{1.0, -0.2}, {1.0, 0.2}}};
    std::vector<VisiblePoint> around;
    visible.around(pose, 4.0, obstacle, nullptr, around);
    std::erase_if(around, [&](const VisiblePoint& point) { return !camera.shows(point.p_robot); });
    std::vector<VisiblePoint> in_view;
    visible.around(pose, 4.0, obstacle, &camera, in_view);
    ASSERT_EQ(in_view.size(), around.size()) << i;
    for (std::size_t k = 0; k < around.size(); ++k) {
      EXPECT_EQ(in_view[k].p_robot, around[k].p_robot);
      EXPECT_EQ(in_view[k].segment, around[k].segment);
    }
    shown += around.size();
    std::vector<VisiblePoint> open;
    Visibility(index, std::vector<std::string>{}).around(pose, 4.0, {}, &camera, open);
    hidden += open.size() - around.size();
  }
  EXPECT_GT(shown, 500u);
  EXPECT_GT(hidden, 500u);
}

TEST(MatchesAny, ComparesNamesAndEndings) {
  const std::vector<std::string> names{"skirting", "*_foot"};
  EXPECT_TRUE(matchesAny("skirting", names));
  EXPECT_TRUE(matchesAny("door_foot", names));
  EXPECT_FALSE(matchesAny("line", names));
  EXPECT_FALSE(matchesAny("foot", names));
}

}  // namespace
}  // namespace vismem
