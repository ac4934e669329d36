/// @file Names that users give to files. Pure.
#pragma once

#include <string>

namespace vismem {

/// @return empty for a usable name: 1..100 letters, digits, '.', '_' or '-', beginning with a letter, digit
/// or
/// '_'. Else value and rule.
std::string checkFileName(const std::string& name);

}  // namespace vismem
