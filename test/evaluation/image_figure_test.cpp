#include "evaluation/figures/image_figure.h"

#include <gmock/gmock.h>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "support/picture_probe.h"

namespace vismem {
namespace {

MapSegment wall(double x1, double y1, double x2, double y2, const char* label = "skirting") {
  return {{{x1, y1, 0.0}, {x2, y2, 0.0}}, label, 0.0};
}

TEST(ImageFigure, ShowsTheMapWhereThePosePutsIt) {
  ImageFigure figure;
  figure.title = "last image, t = 60.00 s";
  figure.analysis.intrinsics = intrinsicsFromFieldOfView(320, 240, degToRad(60.0));
  figure.analysis.T_robot_camera =
      cameraPose({poseFromXyzRpy(0, 0, 0.45, 0, 0, 0), Pose3::Identity()}, 0.0, degToRad(-20.0));
  figure.image = cv::Mat(240, 320, CV_8UC3, cv::Scalar(140, 145, 150));
  figure.T_world_robot = Pose2{1.0, 0.75, 0.0};
  figure.map_edges = {wall(0, 0, 9, 0), wall(0, 1.5, 9, 1.5)};
  const Pose3 T_world_camera = toPose3(*figure.T_world_robot) * figure.analysis.T_robot_camera;
  const auto px = projectSegment(figure.analysis.intrinsics, T_world_camera, {{1.5, 0, 0}, {3.0, 0, 0}});
  ASSERT_TRUE(px);
  figure.analysis.observed.push_back({{{20, 30}, {90, 40}}, "unknown", 20.0});
  figure.analysis.observed.push_back({*px, "skirting", 60.0});
  figure.analysis.predicted.push_back({1, *px, "skirting"});
  figure.analysis.matches.push_back({1, 0});
  const cv::Mat picture = drawLastImage(figure);
  keep(picture, "last_image.png");
  // Pictures are enlarged twice, on a board with margins of 18 and a head of 84; the right one begins at
  // 2 * 18 + 640.
  const auto place = [](const Eigen::Vector2d& at, double left) {
    return Eigen::Vector2d(left + (at.x() + 0.5) * 2.0, 84.0 + (at.y() + 0.5) * 2.0);
  };
  EXPECT_LT(distanceTo(picture, place(px->middle(), 676.0), colors::kMemory), 60) << "the map";
  EXPECT_LT(distanceTo(picture, place({55.0, 35.0}, 18.0), {50, 110, 255}), 60) << "observed only";
  EXPECT_EQ(distanceTo(picture, place({160.0, 200.0}, 676.0), {140, 145, 150}, 0), 0) << "the image itself";
  figure.T_world_robot.reset();
  EXPECT_EQ(drawLastImage(figure).cols, 676) << "without a pose there is one picture";
}

}  // namespace
}  // namespace vismem
