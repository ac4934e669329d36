#include "common/config/properties.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_file.h"

namespace vismem {
namespace {

constexpr const char* kCommandLine = "command line";

/// A character of a line with its backslash already applied.
struct Character {
  char value = 0;
  bool escaped = false;

  bool is(char plain) const { return !escaped && value == plain; }
  bool isBlank() const { return is(' ') || is('\t') || is('\r'); }
};
using Characters = std::vector<Character>;

/// Applies the escapes and drops the comment.
Characters charactersOf(std::string_view line) {
  static constexpr std::string_view kEscapable = "\\#= ";
  if (line.ends_with('\r')) line.remove_suffix(1);
  Characters characters;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '#') break;
    const bool pair = line[i] == '\\' && i + 1 < line.size();
    if (pair && kEscapable.find(line[i + 1]) == std::string_view::npos) characters.push_back({line[i], true});
    if (pair) ++i;
    characters.push_back({line[i], pair});
  }
  return characters;
}

/// The text between the outermost characters that are not blanks.
/// @param keeps_escaped whether escaped blanks are kept: in values, not in keys.
std::string trimmed(Characters::const_iterator begin, Characters::const_iterator end, bool keeps_escaped) {
  const auto drops = [&](const Character& c) {
    return c.isBlank() || (!keeps_escaped && (c.value == ' ' || c.value == '\t'));
  };
  while (begin != end && drops(*begin)) ++begin;
  while (begin != end && drops(*std::prev(end))) --end;
  std::string text;
  for (; begin != end; ++begin) text += begin->value;
  return text;
}

}  // namespace

std::string Origin::text() const {
  return line > 0 ? file + ":" + std::to_string(line) : file;
}

std::string Problem::text() const {
  return origin.text() + ": " + message;
}

Properties Properties::parse(std::string_view text, const std::string& file) {
  static constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  Properties properties;
  properties.source_ = file;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (const auto kind = kindOf(text); !kind.empty() && kind != kConfigurationKind) {
    properties.readable_ = false;
    properties.addProblem(
        {{file, 0}, "is " + std::string(kind) + " (must be a configuration of lines KEY = VALUE)"});
    return properties;
  }
  for (int number = 1; !text.empty(); ++number) {
    const auto end = std::min(text.find('\n'), text.size());
    properties.parseLine(text.substr(0, end), {file, number});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return properties;
}

Properties Properties::load(const std::filesystem::path& file) {
  try {
    return parse(readTextFile(file, "a configuration of lines KEY = VALUE"), file.string());
  } catch (const ConfigError& error) {
    Properties none;
    none.source_ = file.string();
    none.readable_ = false;
    // The message names the file, and so does a problem.
    const auto& line = error.problems().front();
    none.addProblem({{file.string(), 0}, line.substr(line.find(": ") + 2)});
    return none;
  }
}

void Properties::parseLine(std::string_view line, const Origin& origin) {
  const auto characters = charactersOf(line);
  const auto equals =
      std::find_if(characters.begin(), characters.end(), [](const Character& c) { return c.is('='); });
  const auto key = trimmed(characters.begin(), equals, false);
  if (equals == characters.end()) {
    if (!key.empty()) addProblem({origin, "\"" + key + "\" (must be KEY = VALUE)"});
    return;
  }
  const auto value = trimmed(std::next(equals), characters.end(), true);
  if (key.empty()) {
    addProblem({origin, "\"= " + value + "\" has no key (must be KEY = VALUE)"});
    return;
  }
  const auto [entry, added] = entries_.try_emplace(key, Entry{value, origin});
  if (!added) {
    addProblem({origin, "key \"" + key + "\" is set twice (first in line " +
                            std::to_string(entry->second.origin.line) + ")"});
  }
}

void Properties::addArgument(const std::string& argument) {
  const auto equals = argument.find('=');
  if (!argument.starts_with("--") || equals == std::string::npos || equals == 2) {
    addProblem({{kCommandLine, 0}, "\"" + argument + "\" (must be --Key=Value)"});
    return;
  }
  set(argument.substr(2, equals - 2), argument.substr(equals + 1));
}

void Properties::set(const std::string& key, const std::string& value) {
  entries_[key] = Entry{value, {kCommandLine, 0}};
}

const Properties::Entry* Properties::find(const std::string& key) const {
  const auto entry = entries_.find(key);
  return entry == entries_.end() ? nullptr : &entry->second;
}

std::filesystem::path Properties::folder() const {
  return source_ == kCommandLine ? std::filesystem::path() : std::filesystem::path(source_).parent_path();
}

void Properties::throwIfBad() const {
  if (!problems_.empty()) throw ConfigError(problemLines(problems_));
}

std::vector<std::string> problemLines(std::vector<Problem> problems) {
  const auto place = [](const Problem& problem) {
    return std::tuple(problem.origin.file == kCommandLine, problem.origin.file, problem.origin.line);
  };
  std::stable_sort(problems.begin(), problems.end(),
                   [&](const Problem& a, const Problem& b) { return place(a) < place(b); });
  std::vector<std::string> lines;
  for (const auto& problem : problems) lines.push_back(problem.text());
  return lines;
}

}  // namespace vismem
