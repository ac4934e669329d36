/// @file Tests of missing permissions, also where they run as root.
#pragma once

#include <unistd.h>

#include <cstdlib>

namespace vismem {

/// While it lives the whole process is not root, who may open everything. A test must not go on as root by
/// mistake, nor as somebody else.
class SomebodyElse {
 public:
  SomebodyElse() : was_root_(geteuid() == 0) {
    if (was_root_ && seteuid(kNobody) != 0) std::abort();
  }
  ~SomebodyElse() {
    if (was_root_ && seteuid(0) != 0) std::abort();
  }
  SomebodyElse(const SomebodyElse&) = delete;
  SomebodyElse& operator=(const SomebodyElse&) = delete;

 private:
  static constexpr uid_t kNobody = 65534;
  const bool was_root_;
};

}  // namespace vismem
