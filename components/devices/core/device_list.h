/// @file What of a robot's devices is connected to this computer. Nothing is sent to any of them but the
/// kernel's own questions: no port is opened, and nothing moves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vismem {

/// Where a computer tells of its devices; elsewhere in tests.
struct DeviceRoots {
  std::filesystem::path sys = "/sys";
  std::filesystem::path dev = "/dev";
};

struct CameraMode {
  std::string format;  ///< "YUYV", as the driver's key has it; formats that we do not read as V4L2 names them
  int width = 0;
  int height = 0;
  double rate_hz = 0.0;  ///< the highest; 0: not told
};

struct FoundCamera {
  std::string path;                ///< "/dev/video0"
  std::vector<std::string> names;  ///< that stay: "/dev/v4l/by-id/..."
  std::string card, driver, bus;
  std::vector<CameraMode> modes;
  bool turns = false;         ///< tells of absolute pan and tilt
  bool may_be_orbit = false;  ///< of Logitech's numbers: `Motors = orbit` may work
  std::string problem;        ///< "no permission ..."; then nothing but the path is known
};

struct FoundMaestro {
  std::string model;
  std::string serial;
  std::string path;     ///< "/dev/bus/usb/001/004"
  std::string problem;  ///< why it cannot be used
};

struct FoundSerialPort {
  std::string path;  ///< "/dev/ttyUSB0"
  std::vector<std::string> names;
  std::string description;  ///< "FTDI FT232R USB UART, serial A600XXXX"; "16550A at 0x3F8"
  std::string driver;       ///< "ftdi_sio"
  std::string problem;
};

struct FoundDevices {
  std::vector<FoundCamera> cameras;
  std::vector<FoundMaestro> maestros;
  std::vector<FoundSerialPort> serial_ports;
};

/// @return all, sorted by path. Never fails: what cannot be looked at has a `problem`.
FoundDevices listDevices(const DeviceRoots& roots = {});

// Its parts.
std::vector<FoundCamera> listCameras(const DeviceRoots& roots);
std::vector<FoundMaestro> listMaestros(const DeviceRoots& roots);
std::vector<FoundSerialPort> listSerialPorts(const DeviceRoots& roots);
/// Links to a device that udev made: in /dev itself, and in the folders by-id below it.
std::vector<std::string> namesThatStay(const DeviceRoots& roots, const std::filesystem::path& device);

}  // namespace vismem
