/// @file Reading of text files, and escaping of untrusted text for messages.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace vismem {

/// Largest text file [bytes]: above every configuration, map, palette and world. It bounds the reading of
/// endless devices.
inline constexpr std::size_t kMaxTextFile = std::size_t{64} << 20;

/// The whole file.
/// @param expected kind of file: "a map of labelled segments".
/// @throw ConfigError "FILE: cannot be read (REASON; must be EXPECTED)": absent, a folder, a failing device,
/// more than kMaxTextFile bytes.
std::string readTextFile(const std::filesystem::path& file, std::string_view expected);

/// What a file's content seems to be, by its beginning: "a PNG image", "a palette"; empty: unknown.
std::string_view kindOf(std::string_view content);
inline constexpr std::string_view kConfigurationKind = "a configuration";
inline constexpr std::string_view kMapKind = "a map of labelled segments";
inline constexpr std::string_view kPaletteKind = "a palette";

/// The text for one line of a terminal or a UTF-8 message. Control characters and bytes that are not UTF-8
/// become \xNN. A text of more than `most` bytes is shortened to its beginning and end, with the number of
/// bytes left out.
std::string shown(std::string_view text, std::size_t most = 1000);

}  // namespace vismem
