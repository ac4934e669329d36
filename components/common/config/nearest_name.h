/// @file Suggestions for misspelt names: the known name at the smallest edit distance. Pure.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace vismem {

/// Damerau-Levenshtein distance: least number of insertions, deletions, replacements and swaps of neighbours
/// between two texts. Case is ignored, but texts that are not identical have a distance of at least 1.
int typingDistance(std::string_view a, std::string_view b);

/// @return the nearest of `names` within a distance of a quarter of the letters, at least 2; empty otherwise.
/// The first in order wins a tie.
std::string nearestName(std::string_view name, const std::set<std::string>& names);

/// @return ` (did you mean "NAME"?)`, or empty without a near name.
std::string suggestion(std::string_view name, const std::set<std::string>& names);

}  // namespace vismem
