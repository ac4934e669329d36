/// @file A device node on umockdev, whose ioctls a test answers. Tests that use it are declared with
/// EMULATED_DEVICES.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace vismem {

/// Memory of the process that asks: what an ioctl's argument points at, and what that points at in turn.
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
  /// What the pointer at this place points at. @throw std::runtime_error if it cannot be read.
  IoctlMemory at(std::size_t offset, std::size_t size) const;
  /// The process sees what was written.
  void commit() const;
  /// Where it is in the process.
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
  /// @param code the request. @param argument what the argument points at cannot be read before its size is
  /// told: argument(sizeof(v4l2_format)). Called on a thread of umockdev.
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
  /// Whoever has it open gets ENODEV for every request from now on.
  void unplug();
  bool plugged() const;
  /// Where the node is in reality: a program outside of umockdev would find it there.
  std::string realPath() const;

  struct State;

 private:
  std::shared_ptr<State> state_;  ///< with whoever has the node open
};

}  // namespace vismem
