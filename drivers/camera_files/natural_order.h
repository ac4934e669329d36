/// @file Natural order of file names. Pure.
#pragma once

#include <string_view>

namespace vismem {

/// @return whether a comes before b, numbers within names counting as numbers: frame2 before frame10. Names
/// that differ in leading zeros only are ordered as text.
bool naturallyBefore(std::string_view a, std::string_view b);

}  // namespace vismem
