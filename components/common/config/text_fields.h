/// @file Parsing of small text formats: lines without comments, strict numbers. Pure.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace vismem {

/// Largest coordinate of a file [m]: grids and ray tracers fail on places farther from the origin.
inline constexpr double kFarthest_m = 1e5;

/// The text without blanks at both ends.
std::string_view trimmed(std::string_view text);
/// The line without its comment (from `#` on) and without blanks at both ends.
std::string_view contentOf(std::string_view line);
/// A finite number, with blanks around it only.
std::optional<double> finiteNumber(std::string_view word);
/// Letters, digits and _, beginning with a letter: a label, a class of colours.
bool isName(std::string_view word);
/// Parts between separators, empty ones included.
std::vector<std::string_view> splitAt(std::string_view text, char separator);
/// Words between blanks.
std::vector<std::string_view> words(std::string_view text);

}  // namespace vismem
