/// @file MD5 of RFC 1321, a field of JdeRobot's image descriptions. Not for security. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace vismem {

/// @return 32 lower-case hexadecimal digits.
std::string md5Hex(std::span<const std::uint8_t> bytes);

}  // namespace vismem
