/// @file The commit of the sources, for results that name where they come from.
#pragma once

#include <string>

namespace vismem {

/// As `git describe --always --dirty` at the time of the build; "unknown" outside a checkout.
std::string commitId();

}  // namespace vismem
