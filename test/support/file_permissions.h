/// @file Tests of missing permissions, also where they run as root.
#pragma once

#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>

namespace vismem {

/// While it lives, the permissions of files bind this thread, and threads that it starts, even as root, who
/// otherwise may open everything. The user stays who he is, so what belongs to him is still his.
class FilePermissionsCount {
 public:
  FilePermissionsCount() {
    if (syscall(SYS_capget, &header_, before_) != 0) std::abort();
    __user_cap_data_struct fewer[2] = {before_[0], before_[1]};
    fewer[0].effective &= ~((1U << CAP_DAC_OVERRIDE) | (1U << CAP_DAC_READ_SEARCH));
    if (syscall(SYS_capset, &header_, fewer) != 0) std::abort();
  }
  ~FilePermissionsCount() {
    if (syscall(SYS_capset, &header_, before_) != 0) std::abort();
  }
  FilePermissionsCount(const FilePermissionsCount&) = delete;
  FilePermissionsCount& operator=(const FilePermissionsCount&) = delete;

 private:
  __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct before_[2];
};

}  // namespace vismem
