#include "common/config/config_reader.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "common/config/config_error.h"
#include "common/config/nearest_name.h"
#include "common/config/project_file.h"
#include "common/config/text_fields.h"
#include "common/config/text_format.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// The whole text as a number; empty for trailing junk, NaN and infinities.
template <typename T>
std::optional<T> parseNumber(std::string_view text) {
  T value{};
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(value)) return std::nullopt;
  }
  return value;
}

template <typename T>
std::string numberText(T value) {
  std::array<char, 64> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

/// "1..64", "at least 0", "at most 5"; empty without bounds.
std::string rangeText(double minimum, double maximum) {
  if (std::isinf(minimum) && std::isinf(maximum)) return "";
  if (std::isinf(maximum)) return "at least " + numberText(minimum);
  if (std::isinf(minimum)) return "at most " + numberText(maximum);
  return numberText(minimum) + ".." + numberText(maximum);
}

std::string typeRule(const std::string& type, const std::string& range) {
  return "must be " + type + (range.empty() ? "" : ", " + range);
}

std::vector<std::string> wordsOf(const std::string& text) {
  static constexpr const char* kSeparators = ", \t";
  std::vector<std::string> words;
  for (auto begin = text.find_first_not_of(kSeparators); begin != std::string::npos;) {
    const auto end = text.find_first_of(kSeparators, begin);
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kSeparators, end);
  }
  return words;
}

/// A hint for an unknown key: the nearest known key, or the known prefixes for an unknown prefix.
std::string hint(const std::string& name, const std::set<std::string>& known) {
  const auto nearest = suggestion(name, known);
  if (!nearest.empty()) return nearest;
  const auto first = [](const std::string& key) { return key.substr(0, key.find('.') + 1); };
  std::set<std::string> beginnings;
  for (const auto& key : known) beginnings.insert(first(key));
  if (beginnings.contains(first(name))) return "";
  return " (must begin with " + joined(beginnings, " or ") + ")";
}

bool isFromFile(const Properties& properties) {
  return properties.source() != "command line";
}

}  // namespace

struct ConfigReader::State {
  const Properties& properties;
  /// Keys that were read, with their defaults as text.
  std::map<std::string, std::string> defaults;
  /// The same keys as they were first read: a description may refer to the one before.
  std::vector<std::string> order;
  /// Prefixes of keys that other code reads.
  std::vector<std::string> foreign;
  std::vector<Problem> problems;
  /// Old names of keys by their present ones.
  std::map<std::string, std::string> old_names;
  /// Keys without effect, with what became of them.
  std::map<std::string, std::string> retired;
  std::map<std::string, Key> described;
  std::map<std::string, std::string> ranges;
  /// Files that keys name, as they were found.
  struct NamedFile {
    std::string key;
    std::string expected;  ///< "a palette"; empty: any file
  };
  std::map<std::string, NamedFile> files;

  void add(const std::string& key, const std::string& fallback) {
    if (defaults.try_emplace(key, fallback).second) order.push_back(key);
  }
  bool isKnown(const std::string& key) const {
    return defaults.contains(key) || retired.contains(key) ||
           std::any_of(foreign.begin(), foreign.end(),
                       [&](const std::string& beginning) { return key.starts_with(beginning); });
  }
};

ConfigReader::ConfigReader(const Properties& properties, std::string prefix)
    : state_(std::make_shared<State>(State{properties, {}, {}, {}, {}, {}, {}, {}, {}})),
      prefix_(std::move(prefix)) {}

ConfigReader::ConfigReader(std::shared_ptr<State> state, std::string prefix)
    : state_(std::move(state)), prefix_(std::move(prefix)) {}

ConfigReader ConfigReader::group(std::string_view name) const {
  return ConfigReader(state_, key(name));
}

std::string ConfigReader::key(std::string_view name) const {
  return prefix_.empty() ? std::string(name) : prefix_ + "." + std::string(name);
}

bool ConfigReader::isSet(std::string_view name) const {
  return find(key(name)) != nullptr;
}

std::vector<std::string> ConfigReader::children(std::string_view name) const {
  const std::string beginning = key(name) + ".";
  std::set<std::string> names;
  for (const auto& [whole, entry] : state_->properties.entries()) {
    if (!whole.starts_with(beginning)) continue;
    const auto rest = whole.substr(beginning.size());
    names.insert(rest.substr(0, rest.find('.')));
  }
  return {names.begin(), names.end()};
}

const Properties::Entry* ConfigReader::entry(std::string_view name, const std::string& fallback,
                                             const std::string& range) {
  state_->add(key(name), fallback);
  state_->ranges.try_emplace(key(name), range);
  return find(key(name));
}

const Properties::Entry* ConfigReader::find(const std::string& whole) const {
  if (const auto* entry = state_->properties.find(whole)) return entry;
  const auto old = state_->old_names.find(whole);
  return old == state_->old_names.end() ? nullptr : state_->properties.find(old->second);
}

std::string ConfigReader::written(const std::string& whole) const {
  const auto old = state_->old_names.find(whole);
  const bool is_old = old != state_->old_names.end() && state_->properties.find(old->second) != nullptr &&
                      state_->properties.find(whole) == nullptr;
  return is_old ? old->second : whole;
}

void ConfigReader::alias(std::string_view old_name, std::string_view new_name) {
  const std::string old_key = key(old_name);
  const std::string new_key = key(new_name);
  state_->old_names[new_key] = old_key;
  const auto* old = state_->properties.find(old_key);
  if (old && state_->properties.find(new_key)) {
    state_->problems.push_back(
        {old->origin, "key \"" + old_key + "\" is the old name of \"" + new_key + "\", which is set too"});
  }
}

void ConfigReader::retired(std::string_view names, std::string_view why) {
  for (const std::string_view name : words(names))
    state_->retired.insert_or_assign(key(name), std::string(why));
}

std::vector<Problem> ConfigReader::renamedKeys() const {
  std::vector<Problem> lines;
  for (const auto& [name, why] : state_->retired) {
    const auto* set = state_->properties.find(name);
    if (!set) continue;
    lines.push_back({set->origin, "key \"" + name + "\" has no effect any more: " + why +
                                      " (it ends with release " + std::string(kAliasesEnd) + ")"});
  }
  for (const auto& [new_key, old_key] : state_->old_names) {
    const auto* old = state_->properties.find(old_key);
    if (!old) continue;
    lines.push_back({old->origin, "key \"" + old_key + "\" is now called \"" + new_key +
                                      "\" (the old name ends with release " + std::string(kAliasesEnd) +
                                      ")"});
  }
  return lines;
}

void ConfigReader::reject(std::string_view name, const Properties::Entry& entry, std::string_view rule) {
  const auto value = entry.value.empty() ? std::string("(empty)") : entry.value;
  const std::string text = written(key(name)) + " = " + value + " (" + std::string(rule) + ")";
  // A key that two parts read is named once.
  auto& problems = state_->problems;
  if (std::none_of(problems.begin(), problems.end(),
                   [&](const auto& known) { return known.message == text; }))
    problems.push_back({entry.origin, text});
}

void ConfigReader::missing(std::string_view name, std::string_view expected) {
  state_->problems.push_back({{state_->properties.source(), 0},
                              "missing key \"" + key(name) + "\" (must be " + std::string(expected) + ")"});
}

std::optional<double> ConfigReader::number(std::string_view name, const std::string& fallback, double minimum,
                                           double maximum) {
  const auto range = rangeText(minimum, maximum);
  const auto* set = entry(name, fallback, range);
  if (set == nullptr) return std::nullopt;
  const auto value = parseNumber<double>(set->value);
  if (!value) {
    reject(name, *set, typeRule("a number", range));
  } else if (*value < minimum || *value > maximum) {
    reject(name, *set, "must be " + range);
  } else {
    return value;
  }
  return std::nullopt;
}

double ConfigReader::real(std::string_view name, double fallback, double minimum, double maximum) {
  assert(minimum <= fallback && fallback <= maximum);
  return number(name, numberText(fallback), minimum, maximum).value_or(fallback);
}

std::optional<double> ConfigReader::optionalReal(std::string_view name, double minimum, double maximum) {
  return number(name, "", minimum, maximum);
}

double ConfigReader::angleDeg(std::string_view name, double fallback_deg, double minimum_deg,
                              double maximum_deg) {
  assert(name.substr(name.rfind('_') + 1).starts_with("deg"));
  return degToRad(real(name, fallback_deg, minimum_deg, maximum_deg));
}

std::vector<double> ConfigReader::reals(std::string_view name, std::vector<double> fallback, double minimum,
                                        double maximum) {
  std::vector<std::string> fallback_texts;
  for (const double value : fallback) fallback_texts.push_back(numberText(value));
  const std::string range = rangeText(minimum, maximum);
  const auto* set = entry(name, joined(fallback_texts, " "), range);
  if (set == nullptr) return fallback;
  const auto rule = typeRule(std::to_string(fallback.size()) + " numbers", range);
  std::vector<double> values;
  for (const auto& word : wordsOf(set->value)) {
    const auto value = parseNumber<double>(word);
    if (!value || *value < minimum || *value > maximum) {
      reject(name, *set, rule);
      return fallback;
    }
    values.push_back(*value);
  }
  if (values.size() == fallback.size()) return values;
  reject(name, *set, rule);
  return fallback;
}

long ConfigReader::integer(std::string_view name, long fallback, long minimum, long maximum) {
  assert(minimum <= fallback && fallback <= maximum);
  const auto range = numberText(minimum) + ".." + numberText(maximum);
  const auto* set = entry(name, numberText(fallback), range);
  if (set == nullptr) return fallback;
  const auto value = parseNumber<long>(set->value);
  if (value && *value >= minimum && *value <= maximum) return *value;
  reject(name, *set, value ? "must be " + range : typeRule("a whole number", range));
  return fallback;
}

bool ConfigReader::boolean(std::string_view name, bool fallback) {
  const auto* set = entry(name, fallback ? "yes" : "no", "yes or no");
  if (set == nullptr) return fallback;
  for (const char* word : {"true", "yes", "on", "1"}) {
    if (set->value == word) return true;
  }
  for (const char* word : {"false", "no", "off", "0"}) {
    if (set->value == word) return false;
  }
  reject(name, *set, "must be yes or no");
  return fallback;
}

std::string ConfigReader::text(std::string_view name, std::string fallback) {
  const auto* set = entry(name, fallback);
  return set == nullptr ? fallback : set->value;
}

std::string ConfigReader::requiredText(std::string_view name, std::string_view expected) {
  const auto* set = entry(name, "", std::string(expected));
  if (set == nullptr) {
    missing(name, expected);
    return "";
  }
  if (set->value.empty()) reject(name, *set, "must be " + std::string(expected));
  return set->value;
}

std::optional<std::size_t> ConfigReader::choiceIndex(std::string_view name, const std::string& fallback,
                                                     const std::vector<std::string>& words) {
  const std::string rule = "one of: " + joined(words, ", ");
  const auto* set = entry(name, fallback, rule);
  if (set == nullptr) return std::nullopt;
  const auto word = std::find(words.begin(), words.end(), set->value);
  if (word != words.end()) return static_cast<std::size_t>(word - words.begin());
  reject(name, *set, "must be " + rule);
  return std::nullopt;
}

std::filesystem::path ConfigReader::locate(std::string_view name, const std::filesystem::path& value) const {
  const std::filesystem::path found = placeOf(name, value);
  if (!found.empty()) state_->files.insert_or_assign(found.string(), State::NamedFile{key(name), ""});
  return found;
}

std::filesystem::path ConfigReader::placeOf(std::string_view name, const std::filesystem::path& value) const {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (value.empty() || value.is_absolute()) return value;
  const auto* set = find(key(name));
  const bool typed = set != nullptr && set->origin.line == 0;
  if (typed && fs::exists(value, ignored)) return value;
  const fs::path folder = state_->properties.folder();
  const fs::path here = fs::current_path(ignored);
  fs::path found;
  if (isFromFile(state_->properties)) found = findUpwards((here / folder).lexically_normal(), value);
  // The short name where both are the same.
  if (found.empty() || found == here / value) return projectFile(value);
  return found;
}

std::filesystem::path ConfigReader::path(std::string_view name, const std::filesystem::path& fallback) {
  return locate(name, text(name, fallback.string()));
}

std::filesystem::path ConfigReader::outputPath(std::string_view name, const std::filesystem::path& fallback) {
  return text(name, fallback.string());
}

std::filesystem::path ConfigReader::existingPath(std::string_view name,
                                                 const std::filesystem::path& fallback) {
  const auto found = path(name, fallback);
  std::error_code ignored;
  if (found.empty() || std::filesystem::exists(found, ignored)) return found;
  std::string rule = "no such file or folder";
  if (found.is_relative()) {
    const std::string folder = state_->properties.folder().string();
    const std::string here = std::filesystem::current_path(ignored).string();
    rule += " in " + (folder.empty() ? here : folder + ", " + here);
    if (isFromFile(state_->properties)) rule += " or the folders above";
  }
  problem(name, rule);
  return found;
}

std::filesystem::path ConfigReader::existingFile(std::string_view name, std::string_view expected,
                                                 const std::filesystem::path& fallback) {
  const auto problems_before = state_->problems.size();
  const auto found = existingPath(name, fallback);
  if (found.empty() || state_->problems.size() != problems_before) return found;
  state_->files[found.string()].expected = expected;
  std::error_code ignored;
  const std::string rule = "must be " + std::string(expected);
  if (std::filesystem::is_directory(found, ignored)) {
    problem(name, "is a folder, " + rule);
  } else if (!std::ifstream(found)) {
    problem(name, "cannot be opened: " + std::string(std::strerror(errno)) + ", " + rule);
  }
  return found;
}

std::filesystem::path ConfigReader::requireFile(std::string_view name, std::string_view expected) {
  if (requiredText(name, expected).empty()) return {};
  return existingFile(name, expected);
}

std::vector<std::string> ConfigReader::withKeysOf(const std::vector<std::string>& problems) const {
  std::vector<std::string> lines;
  std::set<std::string> said;
  for (const std::string& problem : problems) {
    for (const auto& [file, named] : state_->files) {
      if (!problem.starts_with(file + ":") || !said.insert(file).second) continue;
      const auto* set = find(named.key);
      const std::string origin = set == nullptr ? state_->properties.source() : set->origin.text();
      const std::string what = named.expected.empty() ? "a file" : named.expected;
      lines.push_back(origin + ": " + written(named.key) + " = " + (set == nullptr ? file : set->value) +
                      " (must be " + what + "; what is wrong with it follows)");
    }
    lines.push_back(problem);
  }
  return lines;
}

void ConfigReader::problem(std::string_view name, std::string_view rule) {
  if (const auto* set = find(key(name))) {
    reject(name, *set, rule);
    return;
  }
  const auto fallback = state_->defaults.find(key(name));
  const auto value = fallback == state_->defaults.end() ? std::string() : fallback->second;
  reject(name, {value, {state_->properties.source(), 0}}, "the default; " + std::string(rule));
}

bool ConfigReader::good() const {
  return state_->problems.empty() && state_->properties.problems().empty();
}

ConfigReader& ConfigReader::describe(const Key& described) {
  state_->described.try_emplace(key(described.name), described);
  return *this;
}

void ConfigReader::describe(std::initializer_list<Key> keys) {
  for (const Key& key : keys) describe(key);
}

namespace {

/// A number that was made from radians, without the digits of its rounding: "158.996".
std::string readable(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.size() <= 9 || text.find('.') == std::string::npos || *end != '\0') return text;
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

std::vector<KeyDescription> ConfigReader::keys() const {
  std::vector<KeyDescription> keys;
  for (const std::string& name : state_->order) {
    KeyDescription one{name, readable(state_->defaults[name]), state_->ranges[name], "", false};
    const auto found = state_->described.find(name);
    if (found != state_->described.end()) {
      one.meaning = found->second.meaning;
      one.is_basic = found->second.is_basic;
    }
    keys.push_back(std::move(one));
  }
  return keys;
}

void ConfigReader::known(std::string_view name) {
  const auto whole = key(name);
  if (whole.ends_with(".*")) {
    state_->foreign.push_back(whole.substr(0, whole.size() - 1));
  } else {
    state_->add(whole, "");
  }
}

std::vector<Problem> ConfigReader::allProblems() const {
  auto problems = state_->properties.problems();
  problems.insert(problems.end(), state_->problems.begin(), state_->problems.end());
  if (prefix_.empty()) {
    const auto of_ice = checkIceKeys(state_->properties);
    problems.insert(problems.end(), of_ice.begin(), of_ice.end());
  }
  std::set<std::string> known;
  std::set<std::string> old_names;
  for (const auto& [name, fallback] : state_->defaults) known.insert(name);
  for (const auto& [new_name, old_name] : state_->old_names) old_names.insert(old_name);
  for (const auto& [name, entry] : state_->properties.entries()) {
    const bool checked = prefix_.empty() ? !belongsToIce(name) : name.starts_with(prefix_ + ".");
    if (checked && !state_->isKnown(name) && !old_names.contains(name)) {
      problems.push_back({entry.origin, "unknown key \"" + name + "\"" + hint(name, known)});
    }
  }
  return problems;
}

void ConfigReader::finish() const {
  auto problems = allProblems();
  if (!problems.empty()) throw ConfigError(problemLines(std::move(problems)));
}

std::vector<Setting> ConfigReader::effective() const {
  std::vector<Setting> settings;
  for (const auto& [name, fallback] : state_->defaults) {
    const auto* set = find(name);
    settings.push_back(set == nullptr ? Setting{name, fallback, ""}
                                      : Setting{name, set->value, set->origin.text()});
  }
  return settings;
}

}  // namespace vismem
