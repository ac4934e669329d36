/// @file A virtual machine of QEMU with Debian's kernel and the host's files.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/process/child_process.h"
#include "support/temporary_folder.h"

namespace vismem {

/// Emulated in software (TCG), without root and KVM. The machine has read-only access to the host's whole
/// file system, with its programs; it ends with this object. *Single-threaded*.
class Guest {
 public:
  /// @param boot folder with vmlinuz and initrd.gz (make_boot).
  /// @param ports inside.
  Guest(const std::string& boot, const std::vector<int>& ports);

  /// @return whether it has come up.
  bool waitUntilReady() const;
  /// Output on its console.
  std::string console() const { return machine_->out() + machine_->error(); }

  struct Result {
    int code = -1;  ///< -1: it took too long
    std::string output;
  };
  /// Runs a command of bash.
  Result run(const std::string& command);
  /// A file in the folder that host and guest share: /mnt/NAME inside.
  std::string file(const std::string& name) const;
  void writeFile(const std::string& name, const std::string& content) const;
  /// This machine's port for one inside.
  int port(int inside) const { return ports_.at(inside); }

 private:
  TemporaryFolder shared_;
  std::map<int, int> ports_;
  int commands_ = 0;
  std::unique_ptr<ChildProcess> machine_;
};

}  // namespace vismem
