/// @file "Did you mean ...?" Pure.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace vismem {

/// Least number of insertions, deletions, replacements and swaps of neighbours that turn one text into the
/// other; letters that differ in case only count as equal, but texts that are not identical are at least 1
/// apart.
int typingDistance(std::string_view a, std::string_view b);

/// @return the closest of `names` if it is close enough to be meant (a quarter of the letters, at least 2);
///         empty otherwise. The first in order wins a tie.
std::string nearestName(std::string_view name, const std::set<std::string>& names);

/// @return ` (did you mean "NAME"?)`, or empty when nothing is near.
std::string suggestion(std::string_view name, const std::set<std::string>& names);

}  // namespace vismem
