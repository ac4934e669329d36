#include "simulator/core/world_repair/text_repair.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace vismem {
namespace {

constexpr std::size_t kMaxNotedAttributes = 3;

bool isSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// Length of the UTF-8 sequence at `at`; 0 if there is none.
std::size_t sequenceLength(const std::string& s, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned char first = byte(at);
  const std::size_t length = first < 0x80         ? 1
                             : (first >> 5) == 6  ? 2
                             : (first >> 4) == 14 ? 3
                             : (first >> 3) == 30 ? 4
                                                  : 0;
  if (length == 0 || at + length > s.size() || (length == 2 && first < 0xC2)) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) >> 6) != 2) return 0;
  }
  return length;
}

bool isUtf8(const std::string& s) {
  for (std::size_t at = 0; at < s.size();) {
    const std::size_t length = sequenceLength(s, at);
    if (length == 0) return false;
    at += length;
  }
  return true;
}

std::string fromLatin1(const std::string& s) {
  std::string result;
  for (const char c : s) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      result.push_back(c);
    } else {
      result.push_back(static_cast<char>(0xC0 | (byte >> 6)));
      result.push_back(static_cast<char>(0x80 | (byte & 0x3F)));
    }
  }
  return result;
}

/// Copies one tag that begins at `at` and quotes its bare attribute values.
/// @return its end.
std::size_t copyTag(const std::string& s, std::size_t at, std::string& out,
                    std::vector<std::string>& quoted) {
  const std::size_t begin = at;
  while (at < s.size()) {
    const char c = s[at];
    if (c == '"' || c == '\'') {
      const std::size_t end = std::min(s.find(c, at + 1), s.size() - 1);
      out.append(s, at, end + 1 - at);
      at = end + 1;
      continue;
    }
    if (c == '<' && at > begin) return at;  // a tag without an end: the parser reports it
    out.push_back(c);
    ++at;
    if (c == '>') return at;
    if (c != '=') continue;
    while (at < s.size() && isSpace(s[at])) out.push_back(s[at++]);
    if (at >= s.size() || s[at] == '"' || s[at] == '\'' || s[at] == '>') continue;
    std::size_t end = at;
    while (end < s.size() && !isSpace(s[end]) && s[end] != '>' && s[end] != '"' && s[end] != '<' &&
           !(s[end] == '/' && end + 1 < s.size() && s[end + 1] == '>')) {
      ++end;
    }
    const std::string value = s.substr(at, end - at);
    out.append("\"").append(value).append("\"");
    quoted.push_back(value);
    at = end;
  }
  return at;
}

}  // namespace

std::size_t skipNonElement(const std::string& s, std::size_t at) {
  struct Kind {
    std::string_view begin, end;
  };
  for (const auto& [begin, end] : {Kind{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}, {"<!", ">"}}) {
    if (s.compare(at, begin.size(), begin) != 0) continue;
    const std::size_t found = s.find(end, at + begin.size());
    return found == std::string::npos ? s.size() : found + end.size();
  }
  return at;
}

WorldText repairWorldText(const std::string& bytes) {
  WorldText result;
  if (bytes.find('\0') != std::string::npos) {
    result.notes.emplace_back("is not text in UTF-8 (it holds zero bytes)");
    return result;
  }
  std::string text = bytes;
  if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) text.erase(0, 3);
  if (!isUtf8(text)) {
    text = fromLatin1(text);
    result.notes.emplace_back("is not UTF-8: read as Latin-1");
  }
  int line = 1;
  const auto countLines = [&](std::size_t from, std::size_t to) {
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(from),
                                        text.begin() + static_cast<std::ptrdiff_t>(to), '\n'));
  };
  std::vector<std::string> quoted;
  std::string& out = result.xml;
  out.reserve(text.size() + 64);
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '<') {
      const std::size_t next = std::min(text.find('<', at), text.size());
      out.append(text, at, next - at);
      countLines(at, next);
      at = next;
      continue;
    }
    const std::size_t begin = at;
    const std::size_t skipped = skipNonElement(text, at);
    if (skipped != at) {
      out.append(text, at, skipped - at);
      at = skipped;
    } else {
      at = copyTag(text, at, out, quoted);
    }
    countLines(begin, at);
  }
  if (!quoted.empty()) {
    std::string values;
    for (std::size_t i = 0; i < std::min(quoted.size(), kMaxNotedAttributes); ++i) values += " " + quoted[i];
    result.notes.push_back("is not well-formed XML: " + std::to_string(quoted.size()) +
                           " attribute value(s) without quotes, such as" + values);
  }
  return result;
}

}  // namespace vismem
