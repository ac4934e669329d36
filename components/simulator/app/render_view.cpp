#include "simulator/app/render_view.h"

#include <algorithm>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"

namespace vismem {
namespace {

/// So far up that walls hide nothing.
constexpr double kTopHeight_m = 120.0;
constexpr double kMaxBodySize_m = 50.0;
constexpr double kBorder_m = 0.2;

}  // namespace

cv::Mat renderRobotView(Renderer& renderer, const Pose2& T_world_robot, double pan_rad, double tilt_rad) {
  const SimulationConfig robot;
  return renderer.render(robot.cameras.front().intrinsics,
                         toPose3(T_world_robot) * cameraPose(robot.mount(), pan_rad, tilt_rad));
}

cv::Mat renderTopView(Renderer& renderer, const World& world, int width) {
  Eigen::AlignedBox2d bounds;
  for (const auto& model : world.models) {
    for (const auto& body : model.bodies) {
      Eigen::AlignedBox2d body_bounds;
      for (const auto& vertex : body.vertices) {
        body_bounds.extend((model.pose * vertex.cast<double>()).head<2>());
      }
      if (body_bounds.sizes().maxCoeff() < kMaxBodySize_m) bounds.extend(body_bounds);
    }
  }
  if (bounds.isEmpty()) bounds = Eigen::AlignedBox2d(Eigen::Vector2d(-5, -5), Eigen::Vector2d(5, 5));
  const Eigen::Vector2d size = bounds.sizes() + Eigen::Vector2d::Constant(2 * kBorder_m);
  CameraIntrinsics intrinsics;
  intrinsics.width = width;
  intrinsics.height = std::clamp(static_cast<int>(width * size.y() / size.x()), 16, 4 * width);
  const double scale = std::min(intrinsics.width / size.x(), intrinsics.height / size.y());
  intrinsics.fx = intrinsics.fy = kTopHeight_m * scale;
  intrinsics.cx = 0.5 * (intrinsics.width - 1);
  intrinsics.cy = 0.5 * (intrinsics.height - 1);
  Pose3 T_world_camera = Pose3::Identity();
  T_world_camera.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  T_world_camera.translation() << bounds.center(), kTopHeight_m;
  return renderer.render(intrinsics, T_world_camera);
}

int runRenderCommand(int argc, char** argv) {
  CLI::App app{"Renders one picture of a world as PNG."};
  std::string world_file;
  std::string out;
  std::vector<double> pose{0.0, 0.0, 0.0};
  double pan_deg = 0.0;
  double tilt_deg = 0.0;
  bool top = false;
  std::vector<std::string> model_paths;
  app.add_option("--render", world_file, "World file (SDF)")->required();
  app.add_option("--pose", pose, "x,y,theta of the robot [m, m, rad]")->delimiter(',')->expected(3);
  app.add_option("--pan", pan_deg, "Degrees, > 0 to the left")->check(CLI::Range(-180.0, 180.0));
  app.add_option("--tilt", tilt_deg, "Degrees, > 0 up")->check(CLI::Range(-90.0, 90.0));
  app.add_flag("--top", top, "The whole world from above instead");
  app.add_option("--models", model_paths, "Folders in which model:// names are searched");
  app.add_option("-o,--out", out, "PNG file to write")->required();
  if (const auto code = parseTool(app, argc, argv)) return *code;
  try {
    const Pose2 T_world_robot{pose[0], pose[1], pose[2]};
    if (!isFinite(T_world_robot)) throw ConfigError({"--pose: must be three finite numbers x,y,theta"});
    const LoadedWorld loaded = loadWorld(world_file, {model_paths.begin(), model_paths.end()});
    for (const auto& warning : loaded.warnings) std::cerr << "warning: " << warning << "\n";
    Renderer renderer(loaded.world);
    const std::clock_t begin = std::clock();
    const cv::Mat rgb = top ? renderTopView(renderer, loaded.world)
                            : renderRobotView(renderer, T_world_robot, degToRad(pan_deg), degToRad(tilt_deg));
    const double cpu_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    cv::Mat bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    if (!cv::imwrite(out, bgr)) throw ConfigError({out + ": cannot be written"});
    std::cout << nlohmann::json{{"file", out},
                                {"width", rgb.cols},
                                {"height", rgb.rows},
                                {"bodies", loaded.world.bodyCount()},
                                {"warnings", loaded.warnings.size()},
                                {"first_frame_cpu_ms", cpu_ms}}
                     .dump()
              << std::endl;
    return 0;
  } catch (const ConfigError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "simulator: " << error.what() << "\n";
    return 1;
  }
}

}  // namespace vismem
