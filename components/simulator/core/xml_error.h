/// @file Readable names of tinyxml2's errors. Pure.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace vismem {

/// "XML_ERROR_EMPTY_DOCUMENT" -> "empty document".
inline std::string xmlErrorInWords(std::string name) {
  constexpr std::string_view kBeginning = "XML_ERROR_";
  if (name.starts_with(kBeginning)) name.erase(0, kBeginning.size());
  for (char& c : name) c = c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

}  // namespace vismem
