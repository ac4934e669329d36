#include "common/config/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>
#include <vector>

namespace vismem {
namespace {

bool sameLetter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

/// Longest compared name, above every key: the comparison's time grows with the length.
constexpr std::size_t kLongestName = 200;

/// Length of the dotted groups that both begin with: "A.B." of A.B.C and A.B.D.
std::size_t commonGroup(std::string_view a, std::string_view b) {
  const auto [end, ignored] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const auto dot = a.substr(0, static_cast<std::size_t>(end - a.begin())).rfind('.');
  return dot == std::string_view::npos ? 0 : dot + 1;
}

}  // namespace

int typingDistance(std::string_view a, std::string_view b) {
  if (a == b) return 0;
  // Row i holds the distances between the first i letters of a and every prefix of b.
  std::vector<int> before_last(b.size() + 1);
  std::vector<int> last(b.size() + 1);
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (sameLetter(a[i - 1], b[j - 1]) ? 0 : 1)});
      if (i > 1 && j > 1 && sameLetter(a[i - 1], b[j - 2]) && sameLetter(a[i - 2], b[j - 1])) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
  }
  return std::max(row[b.size()], 1);
}

std::string nearestName(std::string_view name, const std::set<std::string>& names) {
  std::string nearest;
  if (name.size() > kLongestName) return nearest;
  int least = std::numeric_limits<int>::max();
  for (const auto& candidate : names) {
    // The common group is left out of the comparison, because it does not distinguish the names.
    const std::size_t group = commonGroup(name, candidate);
    const int length = static_cast<int>(name.size() - group);
    // A missing unit is a frequent error, independent of its length.
    const bool lacks_unit =
        candidate.starts_with(name) && candidate.size() > name.size() && candidate[name.size()] == '_';
    const int most = std::max(2, length / 4);
    const int distance = typingDistance(name.substr(group), std::string_view(candidate).substr(group));
    if ((lacks_unit || distance <= most) && distance < length && distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string suggestion(std::string_view name, const std::set<std::string>& names) {
  const auto nearest = nearestName(name, names);
  return nearest.empty() ? "" : " (did you mean \"" + nearest + "\"?)";
}

}  // namespace vismem
