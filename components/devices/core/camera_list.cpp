#include <linux/videodev2.h>

#include <algorithm>
#include <fstream>
#include <tuple>

#include "common/v4l2/v4l2_controls.h"
#include "common/v4l2/v4l2_device.h"
#include "devices/core/device_list.h"
#include "drivers/camera_v4l2/negotiation.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

double highestRate(const v4l2::Mode& mode) {
  if (mode.fastest) return mode.fastest->rate_hz();
  double highest_hz = 0.0;
  for (const v4l2::Interval& rate : mode.rates) highest_hz = std::max(highest_hz, rate.rate_hz());
  return highest_hz;
}

/// A QuickCam Orbit or Sphere by its USB ids; only a pan-tilt command shows whether it has motors.
bool isOrbit(const DeviceRoots& roots, const fs::path& node) {
  const auto line = [&](const char* name) {
    std::string text;
    std::ifstream(roots.sys / "class/video4linux" / node.filename() / "device/.." / name) >> text;
    return text;
  };
  const std::string product = line("idProduct");
  return line("idVendor") == "046d" && (product == "08c2" || product == "08cc" || product == "0994");
}

FoundCamera look(const DeviceRoots& roots, const fs::path& node) {
  FoundCamera camera;
  camera.path = node.string();
  camera.names = namesThatStay(roots, node);
  V4l2Device device;
  if (const std::string why = device.open(camera.path); !why.empty()) {
    camera.problem = why.substr(camera.path.size() + 2);
    return camera;
  }
  camera.card = device.identity().card;
  camera.driver = device.identity().driver;
  camera.bus = device.identity().bus;
  if (!device.identity().captures) {
    camera.problem = device.identity().captures_multiplanar
                         ? "gives pictures in several planes, which is not read"
                         : "gives no pictures";
    return camera;
  }
  std::vector<std::string> others;
  for (const v4l2::Mode& mode : v4l2::offeredModes(device, {}, others)) {
    camera.modes.push_back({mode.format.name, mode.width, mode.height, highestRate(mode)});
  }
  for (const std::string& other : others) camera.modes.push_back({other, 0, 0, 0.0});
  camera.turns = findControl(device, V4L2_CID_PAN_ABSOLUTE) && findControl(device, V4L2_CID_TILT_ABSOLUTE);
  camera.may_be_orbit = !camera.turns && isOrbit(roots, node);
  return camera;
}

}  // namespace

std::vector<FoundCamera> listCameras(const DeviceRoots& roots) {
  std::vector<fs::path> nodes;
  std::error_code absent;
  for (const auto& entry : fs::directory_iterator(roots.dev, absent)) {
    const std::string name = entry.path().filename().string();
    const bool numbered = name.size() > 5 && name.starts_with("video") &&
                          name.find_first_not_of("0123456789", 5) == std::string::npos;
    if (numbered && !entry.is_symlink(absent)) nodes.push_back(entry.path());
  }
  // /dev/video10 comes after /dev/video2.
  std::sort(nodes.begin(), nodes.end(), [](const fs::path& a, const fs::path& b) {
    return std::tuple(a.string().size(), a) < std::tuple(b.string().size(), b);
  });
  std::vector<FoundCamera> cameras;
  for (const fs::path& node : nodes) {
    FoundCamera camera = look(roots, node);
    // uvcvideo has a second node for metadata for each camera.
    if (camera.problem != "gives no pictures") cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace vismem
