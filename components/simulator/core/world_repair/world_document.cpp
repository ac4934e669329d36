#include "simulator/core/world_repair/world_document.h"

#include <tinyxml2.h>

#include <map>
#include <set>
#include <string_view>

#include "common/config/config_error.h"
#include "simulator/core/world_includes.h"
#include "simulator/core/world_repair/element_repair.h"
#include "simulator/core/world_repair/unsimulated.h"
#include "simulator/core/xml_error.h"

namespace vismem {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

/// World, model, link, visual, geometry, shape: deeper parts go as one.
constexpr int kMaxNesting = 6;
constexpr const char* kAssumedVersion = "1.6";
constexpr std::size_t kMaxNotes = 20;
/// Elements that stand at a pose.
const std::set<std::string_view> kPlaced{"model",   "link",  "visual",    "collision",
                                         "light",   "frame", "joint",     "sensor",
                                         "include", "actor", "projector", "population"};
/// Parts without which the element around them would be shown wrongly.
const std::set<std::string_view> kEssential{"pose", "geometry"};

std::string describe(const XMLElement& e) {
  const char* name = e.Attribute("name");
  return std::string("<") + e.Name() + (name != nullptr ? " name=\"" + std::string(name) + "\"" : "") + ">";
}

std::string childText(const XMLElement& e, const char* name) {
  const XMLElement* child = e.FirstChildElement(name);
  const char* text = child == nullptr ? nullptr : child->GetText();
  return text == nullptr ? "" : text;
}

int visualsOf(const XMLElement& e) {
  int count = std::string_view(e.Name()) == "visual" ? 1 : 0;
  for (const auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    count += visualsOf(*child);
  }
  return count;
}

LostInclude lostInclude(const XMLElement& e) {
  const std::string uri = childText(e, "uri");
  return {uri, childText(e, "name"), childText(e, "pose"),
          "line " + std::to_string(e.GetLineNum()) + ": <include> of " + uri};
}

/// An include that needs nothing but its model's file, its name and its place.
bool isPlainInclude(const XMLElement& e) {
  static const std::set<std::string_view> kPlain{"uri", "name", "pose", "static", "plugin"};
  if (std::string_view(e.Name()) != "include") return false;
  for (const auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    if (!kPlain.contains(child->Name()) || child->FirstAttribute() != nullptr) return false;
  }
  return e.FirstChildElement("uri") != nullptr;
}

}  // namespace

struct WorldDocument::Impl {
  tinyxml2::XMLDocument document;
  XMLElement* trash = nullptr;  ///< of the same document, but no part of its text
  int tries_left = 0;
  int visuals_lost = 0;

  XMLElement* root() { return document.RootElement(); }
  XMLElement* world() { return root()->FirstChildElement("world"); }

  /// Elements that stand at an unknown place are removed.
  void leaveOutUnplaced(XMLElement& e, std::vector<std::string>& notes) {
    for (XMLElement* child : childrenOf(e)) {
      const std::string text = kPlaced.contains(child->Name()) ? unreadablePose(*child) : "";
      if (text.empty()) {
        leaveOutUnplaced(*child, notes);
        continue;
      }
      note(*child, "", "its <pose> \"" + text + "\" cannot be read (must be 6 numbers: x y z roll pitch yaw)",
           notes);
      e.DeleteChild(child);
    }
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
    if (parts.empty() || depth > kMaxNesting) return false;
    const auto putBack = [&] {
      for (XMLElement* part : parts) e.InsertEndChild(part);
      return false;
    };
    putAway(parts);
    if (!ask(refusal).empty()) return putBack();
    Refused refused;
    findRefused(e, parts, refusal, refused);
    for (const auto& [part, reason] : refused) {
      if (kEssential.contains(part->Name())) return putBack();
    }
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
  void note(const XMLElement& e, const std::string& of, const std::string& reason,
            std::vector<std::string>& notes) {
    // The visuals of an included model are not in this file.
    visuals_lost += std::string_view(e.Name()) == "include" ? 1 : visualsOf(e);
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
  auto* root = document.RootElement();
  if (root == nullptr) throw failure(0, "no XML element");
  const std::string name = root->Name();
  if (name != "sdf" && name != "gazebo")
    throw failure(root->GetLineNum(), "begins with the element <" + name + ">");
  root->SetName("sdf");  // <gazebo> is the older name of the same
  impl_->trash = document.NewElement("trash");
}

WorldDocument::~WorldDocument() = default;

std::vector<std::string> WorldDocument::repair() {
  RepairNotes notes;
  XMLElement& root = *impl_->root();
  if (root.Attribute("version", "1.0") != nullptr) {
    modernizeElements(root);
    root.SetAttribute("version", "1.3");
  }
  removeUnsimulated(root);
  if (root.Attribute("version") == nullptr) {
    root.SetAttribute("version", kAssumedVersion);
    notes.add(root, std::string("no version of SDF: ") + kAssumedVersion + " is assumed");
  }
  std::vector<std::string> unplaced;
  impl_->leaveOutUnplaced(root, unplaced);
  repairElements(root, notes);
  auto result = notes.take();
  result.insert(result.end(), unplaced.begin(), unplaced.end());
  return result;
}

std::vector<std::string> WorldDocument::takeOutRefused(const Refusal& refusal, int tries,
                                                       std::vector<LostInclude>& lost) {
  impl_->tries_left = tries;
  std::vector<std::string> notes;
  XMLElement* world = impl_->world();
  if (world == nullptr) return notes;
  for (XMLElement* child : childrenOf(*world)) {
    if (!isPlainInclude(*child) || isBuiltInModel(childText(*child, "uri"))) continue;
    lost.push_back(lostInclude(*child));
    world->DeleteChild(child);
  }
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
      lost.push_back(lostInclude(*child));
      continue;
    }
    world->InsertEndChild(child);
    const bool kept = impl_->mend(*child, " of " + describe(*child), 1, refusal, notes);
    impl_->trash->InsertEndChild(child);
    if (kept) {
      known->second.clear();
    } else {
      impl_->note(*child, "", known->second, notes);
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
  if (model == nullptr) model = root.FirstChildElement("light");
  if (model == nullptr || impl_->world() != nullptr) return;
  XMLElement* world = impl_->document.NewElement("world");
  world->SetAttribute("name", "one");
  root.InsertFirstChild(world);
  world->InsertEndChild(model);
}

int WorldDocument::visualsLost() const {
  return impl_->visuals_lost;
}

std::string WorldDocument::text() const {
  return impl_->text();
}

}  // namespace vismem
