#include "simulator/core/svg_look.h"

#include <tinyxml2.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

namespace vismem {
namespace {

using tinyxml2::XMLElement;

/// Limit of references from gradient to gradient.
constexpr int kMaxLinks = 16;

std::string textOf(const XMLElement& element) {
  std::string result;
  for (auto* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() != nullptr) result += node->Value();
  }
  return result;
}

}  // namespace

void SvgLooks::collect(const XMLElement& root) {
  if (const std::string id = svgText(root, "id"); !id.empty()) by_id_.emplace(id, &root);
  if (svgNameOf(root) == "style") {
    for (const auto& selector : sheet_.add(textOf(root))) {
      report_.leftOut(root,
                      "the style of \"" + selector + "\" is left out (element, .class and #id are known)");
    }
  }
  for (auto* child = root.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    collect(*child);
  }
}

const XMLElement* SvgLooks::find(const std::string& id) const {
  const auto known = by_id_.find(id);
  return known == by_id_.end() ? nullptr : known->second;
}

/// Attributes, then the style sheets, then the style attribute: the later ones win.
SvgDeclarations SvgLooks::declarationsOf(const XMLElement& e) const {
  SvgDeclarations result;
  for (auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) result[a->Name()] = a->Value();
  for (const auto& [name, value] : sheet_.match(svgNameOf(e), svgText(e, "id"), svgText(e, "class"))) {
    result[name] = value;
  }
  for (const auto& [name, value] : parseSvgDeclarations(svgText(e, "style"))) result[name] = value;
  return result;
}

SvgPaint SvgLooks::paintOf(const XMLElement& e, const std::string& name, const std::string& value,
                           const SvgPaint& otherwise) {
  auto paint = parseSvgPaint(value);
  if (!paint) {
    report_.wrong(e, name, value, "a colour, none, currentColor or url(#gradient)");
    return otherwise;
  }
  if (!paint->reference.empty()) {
    if (const auto color = gradientColor(e, paint->reference, 0)) {
      paint->color = color;
    } else if (!paint->color) {
      report_.leftOut(e,
                      name + " by #" + paint->reference + " is left out (colours and gradients are known)");
    }
    paint->reference.clear();
  }
  return *paint;
}
/// The colour of its first stop: drawing programs store plain colours in such gradients.
std::optional<SvgColor> SvgLooks::gradientColor(const XMLElement& user, const std::string& id, int depth) {
  const auto known = by_id_.find(id);
  if (known == by_id_.end() || depth > kMaxLinks) return std::nullopt;
  const XMLElement& gradient = *known->second;
  std::set<SvgColor> colors;
  std::optional<SvgColor> first;
  for (auto* stop = gradient.FirstChildElement(); stop != nullptr; stop = stop->NextSiblingElement()) {
    if (svgNameOf(*stop) != "stop") continue;
    const auto says = declarationsOf(*stop);
    const auto color = says.find("stop-color");
    const auto paint = parseSvgPaint(color == says.end() ? "black" : color->second);
    if (!paint || !paint->color) continue;
    if (!first) first = paint->color;
    colors.insert(*paint->color);
  }
  if (first) {
    if (colors.size() > 1) report_.leftOut(user, "of the gradient #" + id + " the first colour is used");
    return first;
  }
  const std::string link = svgLinkOf(gradient);
  return link.empty() ? std::nullopt : gradientColor(user, link, depth + 1);
}

double SvgLooks::opacityOf(const XMLElement& e, const std::string& name, const std::string& value,
                           double otherwise) {
  const auto number = parseSvgLength(value);
  if (number && (number->unit.empty() || number->unit == "%")) {
    return std::clamp(number->units(1.0), 0.0, 1.0);
  }
  report_.wrong(e, name, value, "a number in 0..1");
  return otherwise;
}

SvgLook SvgLooks::lookOf(const XMLElement& e, const SvgLook& around) {
  SvgLook look = around;
  look.fixed_width = false;
  const SvgDeclarations says = declarationsOf(e);
  const auto given = [&](const char* name, const std::function<void(const std::string&)>& use) {
    const auto known = says.find(name);
    if (known != says.end() && known->second != "inherit") use(known->second);
  };
  given("color", [&](const std::string& v) {
    if (const auto paint = parseSvgPaint(v); paint && paint->color) look.color = *paint->color;
  });
  given("fill", [&](const std::string& v) { look.fill = paintOf(e, "fill", v, look.fill); });
  given("stroke", [&](const std::string& v) { look.stroke = paintOf(e, "stroke", v, look.stroke); });
  given("stroke-width", [&](const std::string& v) {
    const auto width = parseSvgLength(v);
    if (width && width->value >= 0.0 && width->unit != "%") {
      look.pen.width = width->units(0.0);
    } else {
      report_.wrong(e, "stroke-width", v, "a number of 0 or more, maybe with a unit");
    }
  });
  given("stroke-miterlimit", [&](const std::string& v) {
    if (const auto limit = parseSvgLength(v); limit && limit->value >= 1.0)
      look.pen.miter_limit = limit->value;
  });
  given("stroke-linejoin", [&](const std::string& v) {
    look.pen.join = v == "round"   ? SvgStroke::Join::kRound
                    : v == "bevel" ? SvgStroke::Join::kBevel
                                   : SvgStroke::Join::kMiter;
  });
  given("stroke-linecap", [&](const std::string& v) {
    look.pen.cap = v == "round"    ? SvgStroke::Cap::kRound
                   : v == "square" ? SvgStroke::Cap::kSquare
                                   : SvgStroke::Cap::kButt;
  });
  given("fill-rule", [&](const std::string& v) { look.even_odd = v == "evenodd"; });
  given("visibility", [&](const std::string& v) { look.visible = v == "visible"; });
  given("vector-effect", [&](const std::string& v) { look.fixed_width = v == "non-scaling-stroke"; });
  given("fill-opacity", [&](const std::string& v) {
    look.fill_opacity = opacityOf(e, "fill-opacity", v, look.fill_opacity);
  });
  given("stroke-opacity", [&](const std::string& v) {
    look.stroke_opacity = opacityOf(e, "stroke-opacity", v, look.stroke_opacity);
  });
  given("opacity", [&](const std::string& v) { look.opacity *= opacityOf(e, "opacity", v, 1.0); });
  given("display", [&](const std::string& v) {
    if (v == "none") look.opacity = 0.0;
  });
  given("data-label", [&](const std::string& v) { look.label = v == "none" ? "" : v; });
  for (const char* name : {"clip-path", "mask", "stroke-dasharray"}) {
    given(name, [&](const std::string& v) {
      if (v != "none" && v != "0" && !v.empty()) report_.leftOut(e, std::string(name) + " is not applied");
    });
  }
  return look;
}

}  // namespace vismem
