/// @file Access to a Maestro through libusb. Failures are returned as messages for people.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/pololu_maestro/maestro_codec.h"

namespace vismem::maestro {

/// *Single-threaded* (owner: the driver's thread).
class Usb {
 public:
  Usb();
  ~Usb();

  /// Opens the Maestro with this serial number, or the only one if `serial` is empty.
  /// @return empty, or the reason of the failure: "no Maestro is connected", "no permission for ...".
  std::string open(const std::string& serial);
  bool isOpen() const;
  void close();
  /// Model of the open device.
  const Model& model() const { return *model_; }

  /// @param answer result of read requests.
  /// @return empty, or the reason of the failure: "the Maestro was unplugged".
  std::string transfer(const Request& request, std::vector<std::uint8_t>& answer);
  std::string transfer(const Request& request);

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
  const Model* model_ = nullptr;
};

}  // namespace vismem::maestro
