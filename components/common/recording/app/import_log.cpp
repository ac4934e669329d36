/// @file import_log FOLDER -o FILE.bag: a log folder of JdeRobot's recorder as a bag. See C1.
#include <cmath>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/config/config_error.h"
#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/recording/bag_encoder.h"
#include "common/recording/file_sink.h"
#include "common/recording/jderobot_log.h"
#include "common/recording/picture_decoder.h"
#include "common/recording/ros_messages.h"
#include "common/tool/command_line_tool.h"

namespace {

using namespace vismem;

constexpr std::size_t kChunk = 1 << 20;

struct Options {
  std::string folder;
  std::string out;
  int camera = 1;
  double fov_deg = 0.0;
  double pan_deg = 0.0;
  double tilt_deg = 0.0;
};

Bytes readBytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  const std::string content = text.str();
  return {content.begin(), content.end()};
}

RosCameraInfo cameraInfo(const RosHeader& header, const cv::Size& size, double fov_rad) {
  const CameraIntrinsics k = intrinsicsFromFieldOfView(size.width, size.height, fov_rad);
  RosCameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(size.width);
  info.height = static_cast<std::uint32_t>(size.height);
  info.d.assign(5, 0.0);
  info.k = {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {k.fx, 0.0, k.cx, 0.0, 0.0, k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// Image, calibration and joints of one moment. @return whether the image could be used.
bool addImage(BagEncoder& bag, const JdeRobotLog::Image& image, const Options& options) {
  BagImage picture;
  picture.header.compressed = true;
  picture.data = readBytes(image.file);
  const auto size = pictureSize(picture);
  if (!size || size->width <= 0 || size->height <= 0) return false;
  const RosHeader header{image.stamp_us, "camera_optical_frame"};
  bag.add({"/camera/image_raw/compressed", kCompressedImageType}, image.stamp_us,
          serialize(RosCompressedImage{header, image.format, picture.data}));
  bag.add({"/camera/camera_info", kCameraInfoType}, image.stamp_us,
          serialize(cameraInfo(header, *size, degToRad(options.fov_deg))));
  bag.add(
      {"/joint_states", kJointStateType}, image.stamp_us,
      serialize(RosJointState{
          {image.stamp_us, ""}, {"pan", "tilt"}, {degToRad(options.pan_deg), degToRad(options.tilt_deg)}}));
  return true;
}

void addOdometry(BagEncoder& bag, const JdeRobotLog::Odometry& sample) {
  RosOdometry odometry;
  odometry.header = {sample.stamp_us, "odom"};
  odometry.child_frame_id = "base_footprint";
  odometry.pose = {{sample.x_m, sample.y_m, 0.0},
                   {0.0, 0.0, std::sin(0.5 * sample.theta_rad), std::cos(0.5 * sample.theta_rad)}};
  bag.add({"/odom", kOdometryType}, sample.stamp_us, serialize(odometry));
}

int import(const Options& options) {
  JdeRobotLog log = readJdeRobotLog(options.folder, options.camera);
  FileSink sink(options.out, /*durable=*/true);
  BagEncoder bag(sink, BagCompression::kNone);
  std::size_t unusable = 0;
  std::size_t next = 0;
  for (const JdeRobotLog::Image& image : log.images) {
    for (; next < log.odometry.size() && log.odometry[next].stamp_us <= image.stamp_us; ++next) {
      addOdometry(bag, log.odometry[next]);
    }
    unusable += addImage(bag, image, options) ? 0 : 1;
    if (bag.openBytes() >= kChunk) bag.closeChunk();
  }
  for (; next < log.odometry.size(); ++next) addOdometry(bag, log.odometry[next]);
  bag.finish();
  for (const std::string& note : log.notes) std::cerr << note << "\n";
  if (unusable > 0)
    std::cerr << options.folder << ": " << unusable << " images are neither JPEG nor PNG: left out\n";
  nlohmann::json summary{{"file", options.out},
                         {"images", log.images.size() - unusable},
                         {"odometry_samples", log.odometry.size()},
                         {"notes", log.notes.size() + (unusable > 0 ? 1 : 0)}};
  std::cout << summary.dump() << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Turns a log folder of JdeRobot's recorder (images and encoders) into a ROS 1 bag; the last line is "
      "JSON.");
  Options options;
  app.add_option("FOLDER", options.folder, "with images/cameraN/cameraData.jde and encoders/encoderN/")
      ->required();
  app.add_option("-o,--out", options.out, "the bag; it must not be there yet")->required();
  app.add_option("--camera", options.camera, "number N of the camera")->check(CLI::Range(0, 99));
  app.add_option("--fov", options.fov_deg, "the camera's horizontal field of view [deg], which the log lacks")
      ->required()
      ->check(CLI::Range(1.0, 179.0));
  app.add_option("--pan", options.pan_deg, "of the camera, to the left [deg]")
      ->check(CLI::Range(-180.0, 180.0));
  app.add_option("--tilt", options.tilt_deg, "of the camera, upwards [deg]")->check(CLI::Range(-90.0, 90.0));
  if (const auto code = parseTool(app, argc, argv)) return *code;
  try {
    return import(options);
  } catch (const ConfigError& error) {
    std::cerr << error.what() << "\n";
    return kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
