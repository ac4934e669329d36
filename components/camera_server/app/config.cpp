#include "camera_server/app/config.h"

#include "camera_server/core/camera_info.h"
#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kInfinity = 1e6;
constexpr const char* kCalibrationFile = "a calibration of a camera as ROS writes it";

bool isIdentity(const std::string& name) {
  return name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") ==
         std::string::npos;
}

CameraIntrinsics readLensKeys(ConfigReader lens) {
  CameraIntrinsics k;
  k.width = static_cast<int>(lens.integer("Width_px", 320, 1, kMaxImageSide_px));
  k.height = static_cast<int>(lens.integer("Height_px", 240, 1, kMaxImageSide_px));
  const auto focal = lens.reals("Focal_px", {277.0, 277.0}, 1.0, kInfinity);
  const auto centre = lens.reals("Centre_px", {159.5, 119.5}, -kInfinity, kInfinity);
  const auto d = lens.reals("Distortion", {0.0, 0.0, 0.0, 0.0, 0.0}, -1000.0, 1000.0);
  for (const char* name : {"Width_px", "Height_px", "Focal_px", "Centre_px"}) {
    if (!lens.isSet(name)) lens.requiredText(name, "set where any key of a lens is");
  }
  k.fx = focal[0];
  k.fy = focal[1];
  k.cx = centre[0];
  k.cy = centre[1];
  k.k1 = d[0];
  k.k2 = d[1];
  k.p1 = d[2];
  k.p2 = d[3];
  k.k3 = d[4];
  if (const std::string problem = checkIntrinsics(k); lens.good() && !problem.empty()) {
    lens.problem("Focal_px", problem);
  }
  return k;
}

/// The keys that every camera has, for the listings.
void describeKeys(ConfigReader& group) {
  group.describe(
      {basic("Width_px", "asked of the camera; 0: its own choice"), basic("Height_px", "as Width_px"),
       basic("Rate_hz", "as Width_px"), expert("JpegQuality", "of images that the server encodes"),
       expert("Rotate_deg", "clockwise"), expert("Mirror", "left and right, after the rotation"),
       basic("Calibration", "the lens: a camera_info file of ROS"),
       basic("HorizontalView_deg", "angle of view of a lens without distortion, in place of Calibration")});
}

/// @param file_problems receives the problems of the calibration file, so that the other keys are read too.
Lens readLens(ConfigReader& group, std::vector<std::string>& file_problems) {
  Lens lens;
  const auto file = group.existingFile("Calibration", kCalibrationFile);
  const bool keys = !group.children("Lens").empty();
  if (const auto view_deg = group.optionalReal("HorizontalView_deg", 5.0, 170.0)) {
    lens.horizontal_view_rad = degToRad(*view_deg);
  }
  if ((file.empty() ? 0 : 1) + (keys ? 1 : 0) + (lens.horizontal_view_rad ? 1 : 0) > 1) {
    group.problem(file.empty() ? "HorizontalView_deg" : "Calibration",
                  "must not stand beside another key of the lens: only one of Calibration, Lens.* and "
                  "HorizontalView_deg");
    group.known("Lens.*");
    return lens;
  }
  if (keys) lens.calibrated = readLensKeys(group.group("Lens"));
  std::error_code absent;
  if (std::filesystem::is_regular_file(file, absent)) {
    try {
      lens.calibrated = parseCameraInfo(readTextFile(file, kCalibrationFile), file.string());
    } catch (const ConfigError& error) {
      file_problems.insert(file_problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  return lens;
}

ServedCamera readCamera(ConfigReader group, const std::string& identity,
                        const DriverRegistry<FrameSource>& drivers, std::vector<std::string>& file_problems) {
  ServedCamera served;
  served.identity = identity;
  describeKeys(group);
  served.request.width = static_cast<int>(group.integer("Width_px", 0, 0, kMaxImageSide_px));
  served.request.height = static_cast<int>(group.integer("Height_px", 0, 0, kMaxImageSide_px));
  served.request.rate_hz = group.real("Rate_hz", 0.0, 0.0, 1000.0);
  if (served.request.rate_hz != 0.0 && served.request.rate_hz < kMinFrameRate_hz) {
    group.problem("Rate_hz", "must be 0 or 0.001..1000");
  }
  served.request.accept_native = true;
  served.jpeg_quality = static_cast<int>(group.integer("JpegQuality", served.jpeg_quality, 1, 100));
  Orientation orientation;
  orientation.quarter_turns = group.choice("Rotate_deg", 0, {{"0", 0}, {"90", 1}, {"180", 2}, {"270", 3}});
  orientation.mirror = group.boolean("Mirror", false);
  const Lens lens = readLens(group, file_problems);
  if (auto camera = drivers.make(group)) {
    served.camera = std::make_unique<PreparedCamera>(std::move(camera), orientation, lens);
  }
  return served;
}

}  // namespace

std::vector<ServedCamera> readCameraServerConfig(ConfigReader& reader,
                                                 const DriverRegistry<FrameSource>& drivers) {
  std::vector<ServedCamera> cameras;
  std::vector<std::string> file_problems;
  for (const std::string& identity : reader.children("Camera")) {
    cameras.push_back(readCamera(reader.group("Camera." + identity), identity, drivers, file_problems));
    if (!isIdentity(identity)) {
      reader.problem("Camera." + identity + ".Driver", "a camera's name must be of letters, digits, _ and -");
    }
  }
  // Without any, the message names the key by the example of the first.
  if (cameras.empty()) readCamera(reader.group("Camera.cameraA"), "cameraA", drivers, file_problems);
  if (!file_problems.empty()) throw ConfigError(file_problems);
  return cameras;
}

}  // namespace vismem
