/// @file Tests of missing permissions, also when run as root.
#pragma once

#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>

namespace vismem {

/// During its lifetime file permissions apply to this thread, and threads that it starts, even for root. The
/// user id does not change, so the user's own files stay accessible.
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
