#include "simulator/app/render_view.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/config_error.h"
#include "common/tool/command_line_tool.h"
#include "simulator/app/model_paths.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"

namespace vismem {
namespace {

/// High enough that walls occlude no floor.
constexpr double kTopHeight_m = 120.0;
constexpr double kMaxBodySize_m = 50.0;
constexpr double kBorder_m = 0.2;

}  // namespace

View robotView(const Pose2& T_world_robot, double pan_rad, double tilt_rad) {
  const SimulationConfig robot;
  return {robot.cameras.front().intrinsics,
          toPose3(T_world_robot) * cameraPose(robot.mount(), pan_rad, tilt_rad)};
}

cv::Mat renderRobotView(Renderer& renderer, const Pose2& T_world_robot, double pan_rad, double tilt_rad) {
  const View view = robotView(T_world_robot, pan_rad, tilt_rad);
  return renderer.render(view.intrinsics, view.T_world_camera);
}

View topView(const World& world, int width) {
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
  return {intrinsics, T_world_camera};
}

cv::Mat pictureOfDepth(const TruthImages& truth) {
  cv::Mat millimetres(truth.depth_m.size(), CV_16U);
  for (int v = 0; v < millimetres.rows; ++v) {
    for (int u = 0; u < millimetres.cols; ++u) {
      const double mm = 1e3 * truth.depth_m.at<float>(v, u);
      millimetres.at<std::uint16_t>(v, u) =
          mm < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(std::lround(mm)) : 0;
    }
  }
  return millimetres;
}

cv::Mat pictureOfModels(const TruthImages& truth) {
  cv::Mat ids(truth.model.size(), CV_16U);
  for (int v = 0; v < ids.rows; ++v) {
    for (int u = 0; u < ids.cols; ++u) {
      ids.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(truth.model.at<int>(v, u) + 1);
    }
  }
  return ids;
}

namespace {

struct RenderRequest {
  std::string world_file;
  std::string out;
  std::string depth;
  std::string ids;
  std::string camera;
  std::vector<double> pose{0.0, 0.0, 0.0};
  double pan_deg = 0.0;
  double tilt_deg = 0.0;
  bool top = false;
  std::vector<std::filesystem::path> model_paths;
};

void writePicture(const std::string& file, const cv::Mat& picture) {
  if (!file.empty() && !cv::imwrite(file, picture)) throw ConfigError({file + ": cannot be written"});
}

View chooseView(const RenderRequest& request, const World& world) {
  if (request.top) return topView(world);
  if (request.camera.empty()) {
    const Pose2 T_world_robot{request.pose[0], request.pose[1], request.pose[2]};
    if (!isFinite(T_world_robot)) throw ConfigError({"--pose: must be three finite numbers x,y,theta"});
    return robotView(T_world_robot, degToRad(request.pan_deg), degToRad(request.tilt_deg));
  }
  std::string known;
  for (const auto& camera : world.cameras) {
    if (camera.name == request.camera) return {camera.intrinsics, camera.T_world_camera};
    known += " " + camera.name;
  }
  throw ConfigError({"--camera " + request.camera + ": the world has" +
                     (known.empty() ? " no camera" : " these cameras only:" + known)});
}

void render(const RenderRequest& request) {
  const LoadedWorld loaded = loadWorld(request.world_file, modelPaths(request.model_paths));
  for (const auto& warning : loaded.warnings) std::cerr << "warning: " << warning << "\n";
  Renderer renderer(loaded.world);
  const View view = chooseView(request, loaded.world);
  const std::clock_t begin = std::clock();
  const cv::Mat rgb = renderer.render(view.intrinsics, view.T_world_camera);
  const double cpu_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  writePicture(request.out, bgr);
  nlohmann::json models = nlohmann::json::array();
  if (!request.depth.empty() || !request.ids.empty()) {
    const TruthImages truth = renderer.renderTruth(view.intrinsics, view.T_world_camera);
    if (!request.depth.empty()) writePicture(request.depth, pictureOfDepth(truth));
    if (!request.ids.empty()) writePicture(request.ids, pictureOfModels(truth));
    for (const auto& model : loaded.world.models) models.push_back(model.name);
  }
  nlohmann::json summary{{"file", request.out},         {"width", rgb.cols},
                         {"height", rgb.rows},          {"bodies", loaded.world.bodyCount()},
                         {"visuals", loaded.summary()}, {"warnings", loaded.warnings.size()},
                         {"first_frame_cpu_ms", cpu_ms}};
  if (!request.ids.empty()) summary["models"] = models;
  std::cout << summary.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
}

}  // namespace

int runRenderCommand(int argc, char** argv) {
  CLI::App app{"Renders one image of a world as PNG."};
  RenderRequest request;
  app.add_option("--render", request.world_file, "World file (SDF)")->required();
  app.add_option("--pose", request.pose, "x,y,theta of the robot [m, m, rad]")->delimiter(',')->expected(3);
  app.add_option("--pan", request.pan_deg, "Degrees, > 0 to the left")->check(CLI::Range(-180.0, 180.0));
  app.add_option("--tilt", request.tilt_deg, "Degrees, > 0 up")->check(CLI::Range(-90.0, 90.0));
  app.add_flag("--top", request.top, "View of the whole world from above");
  app.add_option("--camera", request.camera, "View of a camera in the world, as model/link/sensor");
  app.add_option("--depth", request.depth, "Depth image to write (PNG, 16 bits): mm, 0 without a surface");
  app.add_option(
      "--ids", request.ids,
      "Model image to write (PNG, 16 bits): number of the model from 1 (names: in the JSON line), 0 without "
      "a surface");
  app.add_option("--models", request.model_paths,
                 "Folders in which model:// names are searched, before those of GAZEBO_MODEL_PATH and "
                 "GZ_SIM_RESOURCE_PATH");
  app.add_option("-o,--out", request.out, "PNG file to write")->required();
  if (const auto code = parseTool(app, argc, argv)) return *code;
  try {
    render(request);
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
