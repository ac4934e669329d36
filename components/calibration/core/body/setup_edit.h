/// @file Values of keys in a configuration file, changed in its text: comments, order and all other lines
/// stay. Pure.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace vismem {

/// Key and its new value.
using KeyValue = std::pair<std::string, std::string>;

struct EditedText {
  std::string text;
  /// Changed lines as a person reads them: "-14: OLD", "+14: NEW"; empty without a change.
  std::vector<std::string> diff;
};

/// Sets keys in the syntax of Properties. A key that the text has gets its value in place, also where a
/// comment follows it; others are added below the last key with the same first two parts, or at the end.
EditedText setKeys(const std::string& text, const std::vector<KeyValue>& values);

}  // namespace vismem
