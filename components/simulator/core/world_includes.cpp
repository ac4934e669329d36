#include "simulator/core/world_includes.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "simulator/core/world_repair/text_repair.h"

namespace vismem {
namespace {

constexpr const char* kGroundPlane = R"(<static>true</static><link name="link">
<visual name="visual"><geometry><plane><normal>0 0 1</normal><size>200 200</size></plane></geometry>
<material><ambient>0.5 0.5 0.5 1</ambient><diffuse>0.5 0.5 0.5 1</diffuse></material></visual></link></model>)";
constexpr const char* kSun =
    R"(<diffuse>0.8 0.8 0.8 1</diffuse><direction>-0.5 0.1 -0.9</direction></light>)";

bool isSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

std::string trimmed(std::string_view text) {
  while (!text.empty() && isSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && isSpace(text.back())) text.remove_suffix(1);
  return std::string(text);
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

}  // namespace vismem
