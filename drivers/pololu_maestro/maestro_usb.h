/// @file A Maestro found and asked through libusb. Failures are returned with words for people.
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

  /// Opens the Maestro with this serial number; any, if there is one and `serial` is empty. @return empty, or
  /// why not: "no Maestro is connected", "no permission for ...".
  std::string open(const std::string& serial);
  bool isOpen() const;
  void close();
  /// Of an open one.
  const Model& model() const { return *model_; }

  /// @param answer of requests that read. @return empty, or why not: "the Maestro was unplugged".
  std::string transfer(const Request& request, std::vector<std::uint8_t>& answer);
  std::string transfer(const Request& request);

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
  const Model* model_ = nullptr;
};

}  // namespace vismem::maestro
