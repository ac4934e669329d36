#include "common/config/file_name.h"

#include <algorithm>

namespace vismem {

std::string checkFileName(const std::string& name) {
  constexpr std::size_t kMaxName = 100;
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  });
  if (!name.empty() && name.size() <= kMaxName && plain && name.front() != '.' && name.front() != '-')
    return {};
  return "name = \"" + name.substr(0, kMaxName) +
         "\" (must be 1..100 letters, digits, '.', '_' or '-', beginning with a letter, digit or '_')";
}

}  // namespace vismem
