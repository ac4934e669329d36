#include "devices/core/device_report.h"

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

namespace vismem {
namespace {

using nlohmann::json;

std::string head(const std::string& path, const std::vector<std::string>& names, const std::string& what) {
  std::string text = "  " + path + "  " + what + "\n";
  for (const std::string& name : names) text += "      also " + name + "\n";
  return text;
}

std::string problemLine(const std::string& problem) {
  return problem.empty() ? "" : "      ! " + problem + "\n";
}

/// "YUYV 640x480 30 Hz, 1280x720 10 Hz", a line for each format.
std::string modesText(const std::vector<CameraMode>& modes) {
  std::vector<std::string> order;
  std::map<std::string, std::ostringstream> lines;
  for (const CameraMode& mode : modes) {
    if (!lines.contains(mode.format)) order.push_back(mode.format);
    std::ostringstream& line = lines[mode.format];
    if (mode.width == 0) {
      line << " (not read here)";
      continue;
    }
    line << (line.tellp() > 0 ? ", " : " ") << mode.width << "x" << mode.height;
    if (mode.rate_hz > 0.0) line << " " << mode.rate_hz << " Hz";
  }
  std::string text;
  for (const std::string& format : order) text += "      " + format + lines[format].str() + "\n";
  return text;
}

}  // namespace

std::string devicesText(const FoundDevices& devices) {
  std::string text = "Cameras (camera_server: Driver = v4l2, Device = ...)\n";
  for (const FoundCamera& camera : devices.cameras) {
    text += head(camera.path, camera.names,
                 camera.card.empty() ? "" : camera.card + " (" + camera.driver + ", " + camera.bus + ")") +
            modesText(camera.modes) + problemLine(camera.problem);
  }
  if (devices.cameras.empty()) text += "  none\n";
  text +=
      "Pan-tilt units that identify themselves (pantilt_server: Driver = uvc, Device = ...; Driver = "
      "maestro)\n";
  bool any = false;
  for (const FoundCamera& camera : devices.cameras) {
    if (!camera.turns && !camera.may_be_orbit) continue;
    any = true;
    text += "  " + camera.path + "  " + camera.card +
            (camera.turns ? " turns by itself\n" : " is of a kind that turns by itself (Motors = orbit)\n");
  }
  for (const FoundMaestro& maestro : devices.maestros) {
    any = true;
    text += "  " + maestro.path + "  " + maestro.model +
            (maestro.serial.empty() ? "" : ", Serial = " + maestro.serial) + "\n" +
            problemLine(maestro.problem);
  }
  if (!any) text += "  none\n";
  text += "Serial ports (base_server: Driver = pioneer; pantilt_server: Driver = ptu46; Port = ...)\n";
  for (const FoundSerialPort& port : devices.serial_ports) {
    text += head(port.path, port.names,
                 port.description + (port.driver.empty() ? "" : " (" + port.driver + ")")) +
            problemLine(port.problem);
  }
  if (devices.serial_ports.empty()) text += "  none\n";
  return text;
}

json devicesJson(const FoundDevices& devices) {
  json all = {{"cameras", json::array()}, {"maestros", json::array()}, {"serial_ports", json::array()}};
  for (const FoundCamera& camera : devices.cameras) {
    json modes = json::array();
    for (const CameraMode& mode : camera.modes) {
      modes.push_back({{"format", mode.format},
                       {"width", mode.width},
                       {"height", mode.height},
                       {"rate_hz", mode.rate_hz}});
    }
    all["cameras"].push_back({{"path", camera.path},
                              {"names", camera.names},
                              {"card", camera.card},
                              {"driver", camera.driver},
                              {"bus", camera.bus},
                              {"modes", std::move(modes)},
                              {"turns", camera.turns},
                              {"may_be_orbit", camera.may_be_orbit},
                              {"problem", camera.problem}});
  }
  for (const FoundMaestro& maestro : devices.maestros) {
    all["maestros"].push_back({{"model", maestro.model},
                               {"serial", maestro.serial},
                               {"path", maestro.path},
                               {"problem", maestro.problem}});
  }
  for (const FoundSerialPort& port : devices.serial_ports) {
    all["serial_ports"].push_back({{"path", port.path},
                                   {"names", port.names},
                                   {"description", port.description},
                                   {"driver", port.driver},
                                   {"problem", port.problem}});
  }
  return all;
}

}  // namespace vismem
