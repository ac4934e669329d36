/// @file Pieces of our small text formats: lines without comments, strict numbers. Pure.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace vismem {

/// Without what follows a `#`, and without blanks at its ends.
std::string_view contentOf(std::string_view line);
/// A finite number and nothing else but blanks around it.
std::optional<double> finiteNumber(std::string_view word);
/// Parts between separators, empty ones included.
std::vector<std::string_view> splitAt(std::string_view text, char separator);
/// Words between blanks.
std::vector<std::string_view> words(std::string_view text);

}  // namespace vismem
