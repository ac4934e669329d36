#include "calibration/core/body/setup_edit.h"

#include <cstddef>
#include <sstream>
#include <string_view>

#include "common/config/text_fields.h"

namespace vismem {
namespace {

struct Line {
  std::string text;
  std::size_t number = 0;  ///< in the old text; 0: new
};

/// The key that a line sets; empty for comments and others.
std::string_view keyOf(std::string_view line) {
  const auto equals = line.find('=');
  const auto comment = line.find('#');
  if (equals == std::string_view::npos || comment < equals) return {};
  return trimmed(line.substr(0, equals));
}

std::string withValue(const std::string& line, const std::string& value) {
  const auto equals = line.find('=');
  auto comment = line.find(" #", equals);
  std::string changed = line.substr(0, equals + 1) + " " + value;
  if (comment == std::string::npos) return changed;
  while (line[comment - 1] == ' ') --comment;
  return changed + line.substr(comment);
}

/// The first parts of a key, up to its `parts`-th dot.
std::string_view groupOf(std::string_view key, int parts) {
  std::size_t at = 0;
  for (int i = 0; i < parts; ++i) {
    const auto dot = key.find('.', at);
    if (dot == std::string_view::npos) return key;
    at = dot + 1;
  }
  return key.substr(0, at);
}

/// Where a new key belongs: behind the last line of its group.
std::size_t placeFor(const std::vector<Line>& lines, std::string_view key) {
  for (const int parts : {2, 1}) {
    const std::string_view group = groupOf(key, parts);
    for (std::size_t i = lines.size(); i > 0; --i) {
      if (keyOf(lines[i - 1].text).substr(0, group.size()) == group) return i;
    }
  }
  return lines.size();
}

}  // namespace

EditedText setKeys(const std::string& text, const std::vector<KeyValue>& values) {
  std::vector<Line> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back({line, lines.size() + 1});
  EditedText edited;
  for (const auto& [key, value] : values) {
    bool found = false;
    for (Line& line : lines) {
      if (keyOf(line.text) != key) continue;
      found = true;
      const std::string changed = withValue(line.text, value);
      if (changed == line.text) continue;
      edited.diff.push_back("-" + std::to_string(line.number) + ": " + line.text);
      edited.diff.push_back("+" + std::to_string(line.number) + ": " + changed);
      line.text = changed;
    }
    if (found) continue;
    const std::size_t at = placeFor(lines, key);
    const std::size_t number = at == 0 ? 0 : lines[at - 1].number;
    const std::string added = key + " = " + value;
    edited.diff.push_back("+" + std::to_string(number) + ": " + added);
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), Line{added, number});
  }
  for (const Line& line : lines) edited.text += line.text + "\n";
  return edited;
}

}  // namespace vismem
