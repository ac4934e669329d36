/// @file Making of texts: lists, and numbers as by printf. Pure.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

namespace vismem {

/// The texts of the items with a separator between them.
/// @param text_of of an item: a function, or a pointer to a member.
template <typename Items, typename TextOf = std::identity>
std::string joined(const Items& items, std::string_view separator, TextOf text_of = {}) {
  std::string all;
  for (const auto& item : items) {
    if (!all.empty()) all += separator;
    all += std::invoke(text_of, item);
  }
  return all;
}

/// As printf: the compiler checks the values against the pattern.
[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* pattern, ...) {
  std::va_list values;
  va_start(values, pattern);
  std::va_list measured;
  va_copy(measured, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, pattern, measured)), '\0');
  va_end(measured);
  std::vsnprintf(text.data(), text.size() + 1, pattern, values);
  va_end(values);
  return text;
}

}  // namespace vismem
