/// @file A device node on umockdev, whose ioctls a test answers. Tests that use it are declared with
/// EMULATED_DEVICES.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace vismem {

/// Memory of the requesting process: the target of an ioctl's argument, and the targets of pointers in it.
class IoctlMemory {
 public:
  explicit IoctlMemory(void* data);  ///< UMockdevIoctlData; takes over the reference
  IoctlMemory(const IoctlMemory& other);
  IoctlMemory& operator=(const IoctlMemory&) = delete;
  ~IoctlMemory();

  std::uint8_t* bytes() const;
  std::size_t size() const;
  /// As a struct, which may be written to before commit().
  template <typename T>
  T& as() const {
    return *reinterpret_cast<T*>(bytes());
  }
  /// The target of the pointer at this place.
  /// @throw std::runtime_error if it cannot be read.
  IoctlMemory at(std::size_t offset, std::size_t size) const;
  /// Writes the changes to the process.
  void commit() const;
  /// Its address in the process.
  std::uint64_t address() const;

 private:
  void* data_;
};

struct IoctlAnswer {
  long result = 0;
  int error = 0;
  static IoctlAnswer failed(int error) { return {-1, error}; }
};

/// All nodes of a process are on one machine of umockdev's.
/// *Thread-safe*, but for plugIn() and unplug().
class EmulatedNode {
 public:
  /// @param code the request.
  /// @param argument reads the argument, whose size has to be given: argument(sizeof(v4l2_format)). Called on
  /// a thread of umockdev.
  using Handler =
      std::function<IoctlAnswer(unsigned code, const std::function<IoctlMemory(std::size_t)>& argument)>;

  struct Description {
    std::string device;  ///< "/sys/devices/usb1/1-1"
    std::string node;    ///< "/dev/bus/usb/001/002"
    std::string text;    ///< as umockdev-record writes it
  };
  EmulatedNode(Description description, Handler handler);
  ~EmulatedNode();
  EmulatedNode(const EmulatedNode&) = delete;
  EmulatedNode& operator=(const EmulatedNode&) = delete;

  void plugIn();
  /// Every request to an open node fails with ENODEV from now on.
  void unplug();
  bool plugged() const;
  /// The real path of the node, outside of umockdev.
  std::string realPath() const;

  struct State;

 private:
  std::shared_ptr<State> state_;  ///< shared with open descriptors of the node
};

}  // namespace vismem
