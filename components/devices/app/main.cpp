/// @file list_devices: lists the connected devices of a robot. See its --help.
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/tool/command_line_tool.h"
#include "devices/core/device_report.h"

int main(int argc, char** argv) {
  CLI::App app(
      "Lists cameras, pan-tilt units and serial ports that are connected. Nothing is sent to serial ports, "
      "and nothing moves.",
      "list_devices");
  bool json = false;
  app.add_flag("--json", json, "one line for programs");
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  const vismem::FoundDevices devices = vismem::listDevices();
  if (json) {
    // Names of devices may hold any bytes.
    std::cout << vismem::devicesJson(devices).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << std::endl;
  } else {
    std::cout << vismem::devicesText(devices);
  }
  return 0;
}
