/// @file Names of folders that are made now.
#pragma once

#include <string>

namespace vismem {

/// The local time: "20261123-140501".
std::string nameByDate();

}  // namespace vismem
