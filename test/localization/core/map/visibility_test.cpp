// Tests B4.
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
  visible.around({0, 0, 0}, 5.0, points);
  double nearer = 0.0;
  double hidden = 0.0;
  double marking = 0.0;
  for (const VisiblePoint& point : points) {
    (point.p_robot.x() < 1.5 ? marking : point.p_robot.x() < 2.5 ? nearer : hidden) += point.length_m;
  }
  EXPECT_NEAR(marking, 0.4, 1e-9);
  EXPECT_NEAR(nearer, 6.0, 1e-9);  // a marking does not occlude the wall
  EXPECT_EQ(hidden, 0.0);
}

TEST(Visibility, RangeCountsFromTheRobot) {
  SegmentMap map;
  map.segments = {wall(-6, 1, 6, 1)};
  const MapIndex index(map, {});
  const Visibility visible(index, std::vector<std::string>{});
  std::vector<VisiblePoint> points;
  // Half of the chord of a circle of 2 m at 1 m from its middle: sqrt(2 * 2 - 1) = 1.73 m.
  visible.around({1, 0, degToRad(90)}, 2.0, points);
  ASSERT_FALSE(points.empty());
  double length = 0.0;
  for (const VisiblePoint& point : points) {
    EXPECT_NEAR(point.p_robot.x(), 1.0, 1e-9) << "ahead of the robot";
    EXPECT_NEAR(std::abs(std::sin(point.direction_robot)), 1.0, 1e-9);
    length += point.length_m;
  }
  EXPECT_NEAR(length, 2.0 * 1.732, 0.2 + 1e-9) << "within one piece";
}

TEST(CameraView, ShowsTheFloorInTheImageOnly) {
  const ImageAnalysis view = test::emptyView(degToRad(90), degToRad(-20));
  const CameraView camera(view.intrinsics, view.T_robot_camera);
  EXPECT_TRUE(camera.shows({0.0, 1.5})) << "to the left, where the camera looks";
  EXPECT_FALSE(camera.shows({1.5, 0.0}));
  EXPECT_FALSE(camera.shows({0.0, 0.05})) << "under the camera";
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
