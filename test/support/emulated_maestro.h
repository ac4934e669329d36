/// @file A Pololu Maestro for tests of its driver, on umockdev's USB. A test that uses it is declared with
/// EMULATED_DEVICES.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "support/maestro_model.h"

namespace vismem {

/// *Thread-safe*.
class EmulatedMaestro : public MaestroModel {
 public:
  /// Plugged in.
  /// @param number of its USB port, from 1; each only once.
  explicit EmulatedMaestro(std::uint16_t product = 0x0089, const std::string& serial = "00012345",
                           int number = 1);
  ~EmulatedMaestro();

  void unplug();
  void plugIn();
  /// Removes the permission to open it, and restores it.
  void forbid(bool forbidden = true);

 private:
  struct Node;
  std::unique_ptr<Node> node_;
};

}  // namespace vismem
