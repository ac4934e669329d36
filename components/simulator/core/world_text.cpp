#include "simulator/core/world_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

namespace vismem {
namespace {

constexpr const char* kGroundPlane = R"(<static>true</static><link name="link">
<visual name="visual"><geometry><plane><normal>0 0 1</normal><size>200 200</size></plane></geometry>
<material><ambient>0.5 0.5 0.5 1</ambient><diffuse>0.5 0.5 0.5 1</diffuse></material></visual></link></model>)";
constexpr const char* kSun =
    R"(<diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.5 0.1 -0.9</direction></light>)";
constexpr std::size_t kMaxNotedAttributes = 3;

bool isSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

std::string trimmed(std::string_view text) {
  while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && isSpace(text.back())) text.remove_suffix(1);
  return std::string(text);
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

/// End of a comment, a CDATA section or a declaration.
/// @return `at` if an element begins here.
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
    out.push_back(c);
    ++at;
    if (c == '>') return at;
    if (c == '<' && at > begin + 1) return at - 1;  // a tag without an end: the parser reports it
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

/// The text between <name> and </name> in a piece of XML; empty optional if there is none.
std::optional<std::string> textOf(std::string_view xml, std::string_view name) {
  const std::string open = "<" + std::string(name);
  for (std::size_t at = xml.find(open); at != std::string_view::npos; at = xml.find(open, at + 1)) {
    const std::size_t after = at + open.size();
    if (after >= xml.size() || (xml[after] != '>' && !isSpace(xml[after]))) continue;
    const std::size_t begin = xml.find('>', after);
    const std::size_t end = xml.find("</" + std::string(name), after);
    if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return std::nullopt;
    return trimmed(xml.substr(begin + 1, end - begin - 1));
  }
  return std::nullopt;
}

/// Calls use(begin, end) for every `<include>...</include>` outside of comments.
template <typename Use>
void forIncludes(const std::string& xml, const Use& use) {
  constexpr std::string_view kOpen = "<include";
  constexpr std::string_view kClose = "</include>";
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at)) {
    const std::size_t skipped = skipNonElement(xml, at);
    if (skipped != at) {
      at = skipped;
      continue;
    }
    const char next = at + kOpen.size() < xml.size() ? xml[at + kOpen.size()] : '\0';
    if (xml.compare(at, kOpen.size(), kOpen) != 0 || (next != '>' && !isSpace(next))) {
      ++at;
      continue;
    }
    const std::size_t close = xml.find(kClose, at);
    if (close == std::string::npos) return;
    use(at, close + kClose.size());
    at = close + kClose.size();
  }
}

/// Whether a uri refers to a model of Gazebo itself, from its database or from Fuel.
bool namesGazeboModel(std::string uri, std::string_view model) {
  std::string plain;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri.compare(i, 3, "%20") == 0) {
      plain.push_back('_');
      i += 2;
    } else {
      plain.push_back(uri[i] == ' ' ? '_'
                                    : static_cast<char>(std::tolower(static_cast<unsigned char>(uri[i]))));
    }
  }
  while (!plain.empty() && plain.back() == '/') plain.pop_back();
  const std::string wanted(model);
  if (plain == "model://" + wanted || plain == wanted) return true;
  const bool fuel = plain.find("fuel") != std::string::npos && plain.find("://") != std::string::npos;
  return fuel && plain.size() > wanted.size() && plain.ends_with("/" + wanted);
}

}  // namespace

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

bool isBuiltInModel(const std::string& uri) {
  return namesGazeboModel(uri, "sun") || namesGazeboModel(uri, "ground_plane");
}

std::string withBuiltInModels(const std::string& xml) {
  std::string out;
  std::size_t copied = 0;
  forIncludes(xml, [&](std::size_t begin, std::size_t end) {
    const std::string_view include(xml.data() + begin, end - begin);
    const std::string uri = textOf(include, "uri").value_or("");
    if (!isBuiltInModel(uri)) return;
    const bool sun = namesGazeboModel(uri, "sun");
    // A name or a pose between tags is XML already.
    const std::string name = textOf(include, "name").value_or(sun ? "sun" : "ground_plane");
    const std::string pose = textOf(include, "pose").value_or("0 0 0 0 0 0");
    std::string quoted_name = name;
    std::replace(quoted_name.begin(), quoted_name.end(), '"', '\'');
    out.append(xml, copied, begin - copied);
    out += (sun ? "<light type=\"directional\" name=\"" : "<model name=\"") + quoted_name + "\"><pose>" +
           pose + "</pose>" + (sun ? kSun : kGroundPlane);
    copied = end;
  });
  out.append(xml, copied, std::string::npos);
  return out;
}

std::vector<std::string> includedUris(const std::string& xml) {
  std::vector<std::string> uris;
  forIncludes(xml, [&](std::size_t begin, std::size_t end) {
    if (auto uri = textOf(std::string_view(xml.data() + begin, end - begin), "uri")) uris.push_back(*uri);
  });
  return uris;
}

std::string escapeXml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&apos;";
        break;
      default:
        out.push_back(c);
    }
  }
  return out;
}

}  // namespace vismem
