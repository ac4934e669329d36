// list_devices: cameras on umockdev, and Maestros and serial ports in folders like /sys and /dev.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/process/child_process.h"
#include "devices/core/device_report.h"
#include "support/build_paths.h"
#include "support/emulated_camera.h"
#include "support/eventually.h"
#include "support/file_permissions.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Computer {
 public:
  DeviceRoots roots() const { return {folder_.path() / "sys", folder_.path() / "dev"}; }
  void file(const std::string& name, const std::string& content) const {
    const fs::path path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << content << "\n";
  }
  void link(const std::string& name, const std::string& target) const {
    const fs::path path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    fs::create_symlink(folder_.path() / target, path);
  }
  /// A Maestro on the USB bus, with its entries in /sys.
  /// @return its folder.
  std::string maestro(const std::string& product, const std::string& device_number) const {
    const std::string device = "sys/bus/usb/devices/1-2";
    file(device + "/idVendor", "1ffb");
    file(device + "/idProduct", product);
    file(device + "/busnum", "1");
    file(device + "/devnum", device_number);
    return device;
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

 private:
  TemporaryFolder folder_;
};

TEST(SerialPorts, AreNamedByTheirAdapters) {
  const Computer computer;
  const std::string usb = "sys/devices/pci/usb1/1-4";
  computer.file(usb + "/idVendor", "0403");
  computer.file(usb + "/idProduct", "6001");
  computer.file(usb + "/manufacturer", "FTDI");
  computer.file(usb + "/product", "FT232R USB UART");
  computer.file(usb + "/serial", "A600XXXX");
  computer.file(usb + "/1-4:1.0/ttyUSB0/port_number", "0");
  computer.file("sys/bus/usb-serial/drivers/ftdi_sio/bind", "");
  computer.link(usb + "/1-4:1.0/ttyUSB0/driver", "sys/bus/usb-serial/drivers/ftdi_sio");
  computer.link("sys/class/tty/ttyUSB0/device", usb + "/1-4:1.0/ttyUSB0");
  computer.file("dev/ttyUSB0", "");
  computer.link("dev/ttyPIONEER", "dev/ttyUSB0");
  computer.link("dev/serial/by-id/usb-FTDI_FT232R", "dev/ttyUSB0");
  // A port of the mainboard, one that it could have, and a console.
  computer.file("sys/devices/serial8250/driver_override", "");
  computer.link("sys/class/tty/ttyS0/device", "sys/devices/serial8250");
  computer.file("sys/class/tty/ttyS0/type", "4");
  computer.file("sys/class/tty/ttyS0/port", "0x3F8");
  computer.file("dev/ttyS0", "");
  computer.link("sys/class/tty/ttyS1/device", "sys/devices/serial8250");
  computer.file("sys/class/tty/ttyS1/type", "0");
  computer.file("sys/class/tty/tty1/dev", "4:1");

  const auto ports = listSerialPorts(computer.roots());
  ASSERT_EQ(ports.size(), 2U);
  EXPECT_EQ(ports[0].path, computer.path("dev/ttyS0"));
  EXPECT_EQ(ports[0].description, "built-in at 0x3F8");
  EXPECT_EQ(ports[1].description, "FTDI FT232R USB UART, serial A600XXXX");
  EXPECT_EQ(ports[1].driver, "ftdi_sio");
  EXPECT_EQ(ports[1].problem, "");
  EXPECT_THAT(ports[1].names, ElementsAre(computer.path("dev/ttyPIONEER"),
                                          computer.path("dev/serial/by-id/usb-FTDI_FT232R")));
  const std::string text = devicesText({{}, {}, ports});
  EXPECT_THAT(text, HasSubstr("dev/ttyUSB0  FTDI FT232R USB UART, serial A600XXXX (ftdi_sio)\n      also "));
  EXPECT_THAT(text, HasSubstr("...)\n  none\nPan-tilt"));
}

TEST(Maestros, AreNamedByModelAndSerialNumber) {
  const Computer computer;
  computer.file(computer.maestro("008a", "14") + "/serial", "00012345");
  computer.file("sys/bus/usb/devices/1-3/idVendor", "1ffb");
  computer.file("sys/bus/usb/devices/1-3/idProduct", "0001");
  const auto maestros = listMaestros(computer.roots());
  ASSERT_EQ(maestros.size(), 1U);
  EXPECT_EQ(maestros[0].model, "Mini Maestro 12");
  EXPECT_EQ(maestros[0].serial, "00012345");
  EXPECT_EQ(maestros[0].path, computer.path("dev/bus/usb/001/014"));
  EXPECT_EQ(maestros[0].problem, "no such device");
  EXPECT_THAT(devicesText({{}, maestros, {}}),
              HasSubstr("Mini Maestro 12, Serial = 00012345\n      ! no such device"));
}

TEST(Permissions, AreMissedByName) {
  const Computer computer;
  computer.maestro("0089", "2");
  computer.file("dev/bus/usb/001/002", "");
  computer.file("sys/devices/serial8250/driver_override", "");
  computer.link("sys/class/tty/ttyS0/device", "sys/devices/serial8250");
  computer.file("dev/ttyS0", "");
  for (const char* node : {"dev/bus/usb/001/002", "dev/ttyS0"}) {
    fs::permissions(computer.path(node), fs::perms::none);
  }
  const FilePermissionsCount permissions_count;
  const auto maestros = listMaestros(computer.roots());
  ASSERT_EQ(maestros.size(), 1U);
  EXPECT_EQ(maestros[0].problem, "no permission (a udev rule gives it: docs/hardware.md)");
  const auto ports = listSerialPorts(computer.roots());
  ASSERT_EQ(ports.size(), 1U);
  EXPECT_EQ(ports[0].problem, "no permission (serial ports belong to the group dialout)");
}

TEST(Cameras, ReportTheirModesAndWhetherTheyTurn) {
  EmulatedCamera::Description turning;
  turning.card = "Turning Camera";
  turning.modes = {{"YUYV", 640, 480, {30, 15}}, {"H264", 1920, 1080, {30}}};
  turning.controls = {{V4L2_CID_PAN_ABSOLUTE, "Pan", 1, -100, 100, 1, 0, false},
                      {V4L2_CID_TILT_ABSOLUTE, "Tilt", 1, -100, 100, 1, 0, false}};
  EmulatedCamera::Description metadata;
  metadata.number = 1;
  metadata.captures = false;
  EmulatedCamera::Description other;
  other.number = 10;
  other.modes = {{"MJPG", 320, 240, {25}}};
  const EmulatedCamera a(turning);
  const EmulatedCamera b(metadata);
  const EmulatedCamera c(other);

  ChildProcess tool({VISMEM_BIN_DIR "/list_devices", "--json"});
  ASSERT_EQ(tool.waitForExit(kPatience), 0) << tool.error();
  const auto cameras = nlohmann::json::parse(tool.out())["cameras"];
  ASSERT_EQ(cameras.size(), 2U) << cameras;
  EXPECT_EQ(cameras[0]["path"], "/dev/video0");
  EXPECT_EQ(cameras[0]["card"], "Turning Camera");
  EXPECT_EQ(cameras[0]["turns"], true);
  EXPECT_EQ(cameras[0]["modes"].size(), 2U);
  EXPECT_EQ(cameras[0]["modes"][0]["rate_hz"], 30.0);
  EXPECT_EQ(cameras[1]["path"], "/dev/video10");
  EXPECT_EQ(cameras[1]["turns"], false);

  ChildProcess text({VISMEM_BIN_DIR "/list_devices"});
  ASSERT_EQ(text.waitForExit(kPatience), 0);
  EXPECT_THAT(text.out(), HasSubstr("  /dev/video0  Turning Camera (emulated, platform:cam0)\n"
                                    "      YUYV 640x480 30 Hz\n      H264 (not read here)\n"));
  EXPECT_THAT(text.out(), HasSubstr("  /dev/video0  Turning Camera turns by itself\n"));
}

TEST(ListDevices, EndsWithTwoOnAWrongCommandLine) {
  ChildProcess tool({VISMEM_BIN_DIR "/list_devices", "--jsn"});
  EXPECT_EQ(tool.waitForExit(kPatience), 2);
}

}  // namespace
}  // namespace vismem
