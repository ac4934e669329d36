/// @file List of a robot's devices that are connected to this computer. Only queries of the kernel reach the
/// devices: no port is opened, and no device moves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace vismem {

/// Folders in which the system lists its devices; other folders in tests.
struct DeviceRoots {
  std::filesystem::path sys = "/sys";
  std::filesystem::path dev = "/dev";
};

struct CameraMode {
  std::string format;  ///< "YUYV", as in the driver's key; the V4L2 name for formats that no driver reads
  int width = 0;
  int height = 0;
  double rate_hz = 0.0;  ///< the highest; 0: not reported
};

struct FoundCamera {
  std::string path;                ///< "/dev/video0"
  std::vector<std::string> names;  ///< persistent names: "/dev/v4l/by-id/..."
  std::string card, driver, bus;
  std::vector<CameraMode> modes;
  bool turns = false;         ///< has controls of absolute pan and tilt
  bool may_be_orbit = false;  ///< has USB ids of a Logitech Orbit: `Motors = orbit` may work
  std::string problem;        ///< "no permission ..."; then only the path is known
};

struct FoundMaestro {
  std::string model;
  std::string serial;
  std::string path;     ///< "/dev/bus/usb/001/004"
  std::string problem;  ///< reason why it cannot be used
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

/// @return all devices, sorted by path. Never fails: an inaccessible device has a `problem`.
FoundDevices listDevices(const DeviceRoots& roots = {});

// The parts of listDevices.
std::vector<FoundCamera> listCameras(const DeviceRoots& roots);
std::vector<FoundMaestro> listMaestros(const DeviceRoots& roots);
std::vector<FoundSerialPort> listSerialPorts(const DeviceRoots& roots);
/// Links of udev to a device: in /dev itself, and in the folders by-id below it.
std::vector<std::string> namesThatStay(const DeviceRoots& roots, const std::filesystem::path& device);

}  // namespace vismem
