#include "common/config/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

namespace vismem {
namespace {

bool sameLetter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

}  // namespace

int typingDistance(std::string_view a, std::string_view b) {
  if (a == b) return 0;
  // Row i holds the distances between the first i letters of a and every beginning of b.
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
  int least = std::max(2, static_cast<int>(name.size()) / 4) + 1;
  for (const auto& candidate : names) {
    const int distance = typingDistance(name, candidate);
    if (distance < least) {
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
