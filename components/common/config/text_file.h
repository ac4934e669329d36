/// @file Reading a text file that people wrote, and showing in messages what strangers wrote.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace vismem {

/// Larger than any configuration, map, palette or world; a device that never ends is not read for ever.
inline constexpr std::size_t kMaxTextFile = std::size_t{64} << 20;

/// The whole file. @param expected  what it must be: "a map of labelled segments".
/// @throw ConfigError "FILE: cannot be read (REASON; must be EXPECTED)": absent, a folder, a failing device,
/// more than kMaxTextFile bytes.
std::string readTextFile(const std::filesystem::path& file, std::string_view expected);

/// What of it can be shown on one line of a terminal or sent as UTF-8: control characters and bytes that are
/// not UTF-8 as \xNN, and of more than `most` bytes the beginning and the end only, and how many are left
/// out.
std::string shown(std::string_view text, std::size_t most = 1000);

}  // namespace vismem
