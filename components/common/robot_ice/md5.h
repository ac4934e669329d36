/// @file MD5 of RFC 1321, which JdeRobot's image descriptions carry. Not for security. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace vismem {

/// @return 32 lower-case hexadecimal digits.
std::string md5Hex(std::span<const std::uint8_t> bytes);

}  // namespace vismem
