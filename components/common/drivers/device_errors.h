/// @file Messages for the errno of a device node.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace vismem {

struct DeviceKind {
  const char* name;   ///< "serial port"
  const char* group;  ///< its access group: "serial ports belong to the group dialout"
};
inline constexpr DeviceKind kSerialPorts{"serial port", "serial ports belong to the group dialout"};
inline constexpr DeviceKind kVideoDevices{"video device", "cameras belong to the group video"};

/// "no such device", "no permission (...)", "another program uses it", "not a serial port", else the system's
/// words.
inline std::string deviceErrorText(int error, const DeviceKind& kind) {
  switch (error) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
      return "no such device";
    case EACCES:
    case EPERM:
      return std::string("no permission (") + kind.group + ")";
    case EBUSY:
      return "another program uses it";
    case ENOTTY:
    case EISDIR:
      return std::string("not a ") + kind.name;
    default:
      return std::strerror(error);
  }
}

}  // namespace vismem
