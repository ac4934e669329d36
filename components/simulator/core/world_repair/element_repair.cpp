#include "simulator/core/world_repair/element_repair.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/config/text_format.h"

namespace vismem {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kNoNumber = "1e300";

std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::optional<double> numberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) return std::nullopt;
  return error == std::errc() ? value : 0.0;
}

void repairNumbers(XMLElement& e, RepairNotes& notes) {
  const char* text = e.FirstChildElement() == nullptr ? e.GetText() : nullptr;
  if (text == nullptr) return;
  auto words = wordsOf(text);
  if (words.empty() || words.size() > 16) return;
  bool changed = false;
  for (auto& word : words) {
    std::string small;
    for (const char c : word) small.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
    const bool negative = small.starts_with('-');
    if (negative || small.starts_with('+')) small.erase(0, 1);
    if (small == "nan" || small == "inf" || small == "infinity" || small == "1.#qnan" || small == "1.#inf") {
      word = (negative ? "-" : "") + std::string(kNoNumber);
      changed = true;
    } else if (!numberOf(word)) {
      return;  // not a list of numbers
    }
  }
  if (!changed) return;
  e.SetText(joined(words, " ").c_str());
  notes.add(e, std::string("a number of <") + e.Name() + "> is not finite");
}

void repairColor(XMLElement& e, RepairNotes& notes) {
  static const std::set<std::string_view> kColors{"ambient",  "diffuse",    "specular",
                                                  "emissive", "background", "color"};
  const char* text = kColors.contains(e.Name()) && e.FirstChildElement() == nullptr ? e.GetText() : nullptr;
  if (text == nullptr) return;
  std::vector<std::string> clamped;
  bool changed = false;
  for (const auto& word : wordsOf(text)) {
    const auto number = numberOf(word);
    if (!number) return;
    changed = changed || !(*number >= 0.0 && *number <= 1.0);
    clamped.push_back(std::to_string(std::clamp(*number, 0.0, 1.0)));
  }
  if (!changed) return;
  e.SetText(joined(clamped, " ").c_str());
  notes.add(e, std::string("<") + e.Name() + "> is outside 0..1: the nearest colour is taken");
}

/// Every element among its siblings of one kind gets a name of its own.
void repairNamesBelow(XMLElement& parent, RepairNotes& notes) {
  static const std::set<std::string_view> kNamed{"world",     "model", "link",   "visual",
                                                 "collision", "joint", "sensor", "light",
                                                 "frame",     "actor", "road",   "population"};
  const auto nameOf = [](const XMLElement& e) {
    const char* name = e.Attribute("name");
    return std::string(name == nullptr ? "" : name);
  };
  std::set<std::pair<std::string, std::string>> given;
  std::set<std::pair<std::string, std::string>> seen;
  std::map<std::string, int> last_number;
  const auto children = childrenOf(parent);
  for (const XMLElement* child : children) given.emplace(child->Name(), nameOf(*child));
  for (XMLElement* child : children) {
    const std::string kind = child->Name();
    const std::string name = nameOf(*child);
    if (!kNamed.contains(kind) || (!name.empty() && seen.emplace(kind, name).second)) continue;
    const std::string base =
        name.empty() ? "unnamed_" + kind + "_" + std::to_string(child->GetLineNum()) : name;
    std::string free = base;
    for (int& i = last_number.emplace(base, 1).first->second; !given.emplace(kind, free).second;) {
      free = base + "_" + std::to_string(++i);
    }
    child->SetAttribute("name", free.c_str());
    notes.add(*child,
              "<" + kind + "> has " +
                  (name.empty() ? "no name"
                                : "the name \"" + name + "\" of another: it is called \"" + free + "\""));
  }
}

}  // namespace

std::vector<XMLElement*> childrenOf(XMLElement& e) {
  std::vector<XMLElement*> result;
  for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    result.push_back(child);
  }
  return result;
}

void RepairNotes::add(const XMLElement& e, const std::string& what) {
  auto& seen = seen_.try_emplace(what, e.GetLineNum(), 0).first->second;
  ++seen.second;
}

std::vector<std::string> RepairNotes::take() const {
  std::vector<std::pair<int, std::string>> sorted;
  for (const auto& [what, seen] : seen_) {
    sorted.emplace_back(seen.first,
                        "line " + std::to_string(seen.first) + ": " + what +
                            (seen.second > 1 ? " (" + std::to_string(seen.second) + " times)" : ""));
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::string> result;
  for (const auto& [line, note] : sorted) result.push_back(note);
  return result;
}

std::string unreadablePose(const XMLElement& e) {
  const XMLElement* pose = e.FirstChildElement("pose");
  const char* text = pose != nullptr ? pose->GetText() : nullptr;
  if (text == nullptr) return "";
  const auto words = wordsOf(text);
  const bool quaternion = pose->Attribute("rotation_format", "quat_xyzw") != nullptr;
  const bool numbers = std::all_of(words.begin(), words.end(),
                                   [](const std::string& word) { return numberOf(word).has_value(); });
  if (words.empty() || (numbers && words.size() == (quaternion ? 7u : 6u))) return "";
  return text;
}

void modernizeElements(XMLElement& e) {
  for (XMLElement* child : childrenOf(e)) modernizeElements(*child);
  static const std::set<std::string_view> kKept{"name", "type", "version", "filename"};
  std::vector<std::pair<std::string, std::string>> values;
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next())
    values.emplace_back(a->Name(), a->Value());
  const std::string kind = e.Name();
  for (const auto& [name, value] : values) {
    const bool is_mesh = kind == "mesh" && name == "filename";
    if (kKept.contains(name) && !is_mesh) continue;
    e.DeleteAttribute(name.c_str());
    if (name == "rgba" || name == "xyz" || (kind == "origin" && name == "pose")) {
      e.SetText(value.c_str());
    } else if (kind == "material" && name == "script") {
      e.InsertNewChildElement("script")->InsertNewChildElement("name")->SetText(value.c_str());
    } else {
      e.InsertNewChildElement(is_mesh ? "uri" : name.c_str())->SetText(value.c_str());
    }
  }
  if (kind == "origin") e.SetName("pose");
}

void repairElements(XMLElement& e, RepairNotes& notes) {
  for (XMLElement* child : childrenOf(e)) {
    // In the state of a saved world names refer to others.
    if (std::string_view(child->Name()) != "plugin") repairElements(*child, notes);
  }
  repairNumbers(e, notes);
  repairColor(e, notes);
  repairNamesBelow(e, notes);
}

}  // namespace vismem
