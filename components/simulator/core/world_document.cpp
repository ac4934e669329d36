#include "simulator/core/world_document.h"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "common/config/config_error.h"
#include "simulator/core/xml_error.h"

namespace vismem {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

/// World, model, link, visual, geometry, shape: deeper parts go as one.
constexpr int kMaxDepth = 6;
constexpr const char* kNoNumber = "1e300";
constexpr const char* kAssumedVersion = "1.6";
constexpr std::size_t kMaxNotes = 20;

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

std::string describe(const XMLElement& e) {
  const char* name = e.Attribute("name");
  return std::string("<") + e.Name() + (name != nullptr ? " name=\"" + std::string(name) + "\"" : "") + ">";
}

std::string childText(const XMLElement& e, const char* name) {
  const XMLElement* child = e.FirstChildElement(name);
  const char* text = child == nullptr ? nullptr : child->GetText();
  return text == nullptr ? "" : text;
}

std::vector<XMLElement*> childrenOf(XMLElement& e) {
  std::vector<XMLElement*> result;
  for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    result.push_back(child);
  }
  return result;
}

/// Equal repairs become one note, at their first line.
class Notes {
 public:
  void add(const XMLElement& e, const std::string& what) {
    auto& seen = seen_.try_emplace(what, e.GetLineNum(), 0).first->second;
    ++seen.second;
  }
  std::vector<std::string> take() const {
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

 private:
  std::map<std::string, std::pair<int, int>> seen_;
};

}  // namespace

struct WorldDocument::Impl {
  tinyxml2::XMLDocument document;
  XMLElement* trash = nullptr;  ///< of the same document, but no part of its text
  int tries_left = 0;

  XMLElement* root() { return document.RootElement(); }
  XMLElement* world() { return root()->FirstChildElement("world"); }

  // --- repairs ---
  void repairNumbers(XMLElement& e, Notes& notes) {
    const char* text = e.FirstChildElement() == nullptr ? e.GetText() : nullptr;
    if (text == nullptr) return;
    auto words = wordsOf(text);
    if (words.empty() || words.size() > 16) return;
    bool changed = false;
    for (auto& word : words) {
      std::string small;
      for (const char c : word)
        small.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(c))));
      const bool negative = small.starts_with('-');
      if (negative || small.starts_with('+')) small.erase(0, 1);
      if (small == "nan" || small == "inf" || small == "infinity" || small == "1.#qnan" ||
          small == "1.#inf") {
        word = (negative ? "-" : "") + std::string(kNoNumber);
        changed = true;
      } else if (!numberOf(word)) {
        return;  // not a list of numbers
      }
    }
    if (!changed) return;
    std::string joined;
    for (const auto& word : words) joined += (joined.empty() ? "" : " ") + word;
    e.SetText(joined.c_str());
    notes.add(e, std::string("a number of <") + e.Name() + "> is not finite");
  }

  void repairColor(XMLElement& e, Notes& notes) {
    static const std::set<std::string_view> kColors{"ambient",  "diffuse",    "specular",
                                                    "emissive", "background", "color"};
    const char* text = kColors.contains(e.Name()) && e.FirstChildElement() == nullptr ? e.GetText() : nullptr;
    if (text == nullptr) return;
    std::string clamped;
    bool changed = false;
    for (const auto& word : wordsOf(text)) {
      const auto number = numberOf(word);
      if (!number) return;
      changed = changed || !(*number >= 0.0 && *number <= 1.0);
      clamped += (clamped.empty() ? "" : " ") + std::to_string(std::clamp(*number, 0.0, 1.0));
    }
    if (!changed) return;
    e.SetText(clamped.c_str());
    notes.add(e, std::string("<") + e.Name() + "> is outside 0..1: the nearest colour is taken");
  }

  void repairName(XMLElement& e, Notes& notes) {
    static const std::set<std::string_view> kNamed{"world",     "model", "link",   "visual",
                                                   "collision", "joint", "sensor", "light",
                                                   "frame",     "actor", "road",   "population"};
    const char* name = e.Attribute("name");
    if (!kNamed.contains(e.Name()) || (name != nullptr && *name != '\0')) return;
    const std::string given = std::string("unnamed_") + e.Name() + "_" + std::to_string(e.GetLineNum());
    // On one line there may be several.
    std::string free = given;
    const auto taken = [&](const std::string& wanted) {
      for (const XMLNode* other = e.Parent()->FirstChild(); other != nullptr; other = other->NextSibling()) {
        const XMLElement* element = other->ToElement();
        if (element != nullptr && element != &e && element->Attribute("name", wanted.c_str()) != nullptr)
          return true;
      }
      return false;
    };
    for (int i = 2; taken(free); ++i) free = given + "_" + std::to_string(i);
    e.SetAttribute("name", free.c_str());
    notes.add(e, std::string("<") + e.Name() + "> has no name");
  }

  void repairBelow(XMLElement& e, Notes& notes) {
    for (XMLElement* child : childrenOf(e)) {
      // In the state of a saved world names refer to others.
      if (std::string_view(child->Name()) != "plugin") repairBelow(*child, notes);
    }
    repairNumbers(e, notes);
    repairColor(e, notes);
    repairName(e, notes);
  }

  // --- taking out ---
  std::string text() const {
    tinyxml2::XMLPrinter printer(nullptr, true);
    document.Accept(&printer);
    return printer.CStr();
  }
  std::string ask(const Refusal& refusal) { return --tries_left < 0 ? "" : refusal(text()); }
  void putAway(const std::vector<XMLElement*>& parts) {
    for (XMLElement* part : parts) trash->InsertEndChild(part);
  }

  /// The parts of an element that are rejected even without the others, found by bisection. All are removed
  /// before and after.
  using Refused = std::map<XMLElement*, std::string>;
  void findRefused(XMLElement& e, const std::vector<XMLElement*>& parts, const Refusal& refusal,
                   Refused& found) {
    if (parts.empty()) return;
    for (XMLElement* part : parts) e.InsertEndChild(part);
    const std::string reason = ask(refusal);
    putAway(parts);
    if (reason.empty()) return;
    if (parts.size() == 1) {
      found[parts[0]] = reason;
      return;
    }
    const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
    findRefused(e, {parts.begin(), middle}, refusal, found);
    findRefused(e, {middle, parts.end()}, refusal, found);
  }

  /// Removes the invalid parts of a rejected element. The document contains only this element and its
  /// ancestors.
  /// @return whether a part of it may stay.
  bool mend(XMLElement& e, const std::string& of, int depth, const Refusal& refusal,
            std::vector<std::string>& notes) {
    const auto parts = childrenOf(e);
    if (parts.empty() || depth > kMaxDepth) return false;
    putAway(parts);
    if (!ask(refusal).empty()) return false;
    Refused refused;
    findRefused(e, parts, refusal, refused);
    for (auto& [part, reason] : refused) {
      e.InsertEndChild(part);
      // The contents of includes are not in this file.
      if (std::string_view(part->Name()) != "include" && mend(*part, of, depth + 1, refusal, notes))
        reason.clear();
      trash->InsertEndChild(part);
    }
    for (XMLElement* part : parts) {
      const auto known = refused.find(part);
      if (known == refused.end() || known->second.empty()) {
        e.InsertEndChild(part);
      } else {
        note(*part, of, known->second, notes);
      }
    }
    return true;
  }
  static void note(const XMLElement& e, const std::string& of, const std::string& reason,
                   std::vector<std::string>& notes) {
    if (notes.size() < kMaxNotes) {
      notes.push_back("line " + std::to_string(e.GetLineNum()) + ": " + describe(e) + of +
                      " is left out: " + reason);
    }
  }
};

WorldDocument::WorldDocument(const std::string& xml, const std::string& file)
    : impl_(std::make_unique<Impl>()) {
  const auto failure = [&](int line, const std::string& what) {
    return ConfigError(
        {file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what + " (must be a world in SDF)"});
  };
  auto& document = impl_->document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
    throw failure(document.ErrorLineNum(), "not XML: " + xmlErrorInWords(document.ErrorName()));
  }
  const auto* root = document.RootElement();
  if (root == nullptr) throw failure(0, "no XML element");
  const std::string name = root->Name();
  if (name != "sdf" && name != "gazebo") {  // the older name of the same
    throw failure(root->GetLineNum(), "begins with the element <" + name + ">");
  }
  impl_->trash = document.NewElement("trash");
}

WorldDocument::~WorldDocument() = default;

std::vector<std::string> WorldDocument::repair() {
  Notes notes;
  XMLElement& root = *impl_->root();
  if (root.Attribute("version") == nullptr) {
    root.SetAttribute("version", kAssumedVersion);
    notes.add(root, std::string("no version of SDF: ") + kAssumedVersion + " is assumed");
  }
  impl_->repairBelow(root, notes);
  return notes.take();
}

std::vector<std::string> WorldDocument::takeOutRefused(const Refusal& refusal, int tries,
                                                       std::vector<LostInclude>& lost) {
  impl_->tries_left = tries;
  std::vector<std::string> notes;
  XMLElement* world = impl_->world();
  if (world == nullptr) return notes;
  const auto children = childrenOf(*world);
  impl_->putAway(children);
  Impl::Refused refused;
  if (const std::string reason = impl_->ask(refusal); !reason.empty()) {
    for (XMLElement* child : children) world->InsertEndChild(child);
    return notes;
  }
  impl_->findRefused(*world, children, refusal, refused);
  for (XMLElement* child : children) {
    const auto known = refused.find(child);
    if (known == refused.end()) continue;
    if (std::string_view(child->Name()) == "include") {
      const std::string uri = childText(*child, "uri");
      lost.push_back({uri, childText(*child, "name"), childText(*child, "pose"),
                      "line " + std::to_string(child->GetLineNum()) + ": <include> of " + uri});
      continue;
    }
    world->InsertEndChild(child);
    const bool kept = impl_->mend(*child, " of " + describe(*child), 1, refusal, notes);
    impl_->trash->InsertEndChild(child);
    if (kept) {
      known->second.clear();
    } else {
      Impl::note(*child, "", known->second, notes);
    }
  }
  for (XMLElement* child : children) {
    const auto known = refused.find(child);
    if (known == refused.end() || known->second.empty()) world->InsertEndChild(child);
  }
  if (impl_->tries_left < 0) notes.emplace_back("too much of it is wrong to look at all of it");
  return notes;
}

void WorldDocument::wrapModel() {
  XMLElement& root = *impl_->root();
  XMLElement* model = root.FirstChildElement("model");
  if (model == nullptr || impl_->world() != nullptr) return;
  XMLElement* world = impl_->document.NewElement("world");
  world->SetAttribute("name", "one");
  root.InsertFirstChild(world);
  world->InsertEndChild(model);
}

std::string WorldDocument::text() const {
  return impl_->text();
}

}  // namespace vismem
