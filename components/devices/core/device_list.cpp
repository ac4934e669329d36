#include "devices/core/device_list.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>

#include "common/drivers/device_errors.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

/// A line of a file of /sys; empty if there is none.
std::string lineOf(const fs::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::error_code absent;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder, absent)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// The USB device of a path in /sys.
std::optional<fs::path> usbDeviceAbove(fs::path path) {
  std::error_code error;
  for (path = fs::canonical(path, error); !error && path.has_relative_path(); path = path.parent_path()) {
    if (fs::exists(path / "idVendor", error)) return path;
  }
  return std::nullopt;
}

std::string describeUsb(const fs::path& device) {
  const std::string maker = lineOf(device / "manufacturer");
  const std::string product = lineOf(device / "product");
  const std::string serial = lineOf(device / "serial");
  std::string text = maker;
  if (!product.empty()) text += (text.empty() ? "" : " ") + product;
  if (text.empty()) text = "USB " + lineOf(device / "idVendor") + ":" + lineOf(device / "idProduct");
  return serial.empty() ? text : text + ", serial " + serial;
}

std::string mayUse(const fs::path& node, const std::string& hint) {
  std::error_code error;
  if (!fs::exists(node, error)) return "no such device";
  return faccessat(AT_FDCWD, node.c_str(), R_OK | W_OK, AT_EACCESS) == 0 ? ""
                                                                         : "no permission (" + hint + ")";
}

}  // namespace

std::vector<std::string> namesThatStay(const DeviceRoots& roots, const fs::path& device) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::path& folder : {roots.dev, roots.dev / "serial/by-id", roots.dev / "v4l/by-id"}) {
    for (const fs::path& entry : entriesOf(folder)) {
      if (!fs::is_symlink(entry, error) || entry == device) continue;
      if (fs::equivalent(entry, device, error) && !error) names.push_back(entry.string());
    }
  }
  return names;
}

std::vector<FoundMaestro> listMaestros(const DeviceRoots& roots) {
  static const std::map<std::string, std::string> kModels{{"0089", "Micro Maestro 6"},
                                                          {"008a", "Mini Maestro 12"},
                                                          {"008b", "Mini Maestro 18"},
                                                          {"008c", "Mini Maestro 24"}};
  std::vector<FoundMaestro> found;
  for (const fs::path& device : entriesOf(roots.sys / "bus/usb/devices")) {
    if (lineOf(device / "idVendor") != "1ffb") continue;
    const auto model = kModels.find(lineOf(device / "idProduct"));
    if (model == kModels.end()) continue;
    const auto padded = [&](const char* name) {
      const std::string number = lineOf(device / name);
      return std::string(number.size() < 3 ? 3 - number.size() : 0, '0') + number;
    };
    const fs::path node = roots.dev / "bus/usb" / padded("busnum") / padded("devnum");
    found.push_back({model->second, lineOf(device / "serial"), node.string(),
                     mayUse(node, "a udev rule gives it: docs/hardware.md")});
  }
  return found;
}

std::vector<FoundSerialPort> listSerialPorts(const DeviceRoots& roots) {
  std::vector<FoundSerialPort> found;
  std::error_code error;
  for (const fs::path& tty : entriesOf(roots.sys / "class/tty")) {
    // Consoles and pseudo terminals have no device behind them.
    if (!fs::exists(tty / "device", error)) continue;
    const std::string type = lineOf(tty / "type");
    if (type == "0") continue;  // a possible port without hardware
    FoundSerialPort port;
    const fs::path node = roots.dev / tty.filename();
    port.path = node.string();
    port.names = namesThatStay(roots, node);
    port.driver = fs::read_symlink(tty / "device/driver", error).filename().string();
    if (const auto usb = usbDeviceAbove(tty / "device")) {
      port.description = describeUsb(*usb);
    } else {
      const std::string where = lineOf(tty / "port");
      port.description = "built-in" + (where.empty() || where == "0x0" ? "" : " at " + where);
    }
    port.problem = mayUse(node, kSerialPorts.group);
    found.push_back(std::move(port));
  }
  return found;
}

FoundDevices listDevices(const DeviceRoots& roots) {
  return {listCameras(roots), listMaestros(roots), listSerialPorts(roots)};
}

}  // namespace vismem
