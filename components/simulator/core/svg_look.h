/// @file The style of a drawing's elements: attributes, style sheets, inheritance, gradients. Private to its
/// reader.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "simulator/core/svg_path.h"
#include "simulator/core/svg_report.h"
#include "simulator/core/svg_style.h"

namespace vismem {

/// Inherited and own style of an element.
struct SvgLook {
  SvgPaint fill{SvgColor{0, 0, 0}, false, ""};
  SvgPaint stroke;
  SvgColor color{0, 0, 0};
  SvgStroke pen;
  bool even_odd = false;
  bool visible = true;
  double fill_opacity = 1.0;
  double stroke_opacity = 1.0;
  double opacity = 1.0;  // of all around it, multiplied
  bool fixed_width = false;
  std::string label;
};

/// *Single-threaded.* The document must outlive it.
class SvgLooks {
 public:
  explicit SvgLooks(SvgReport& report) : report_(report) {}

  /// Reads the style sheets and ids of a whole document.
  void collect(const tinyxml2::XMLElement& root);
  /// The element of that id; null if there is none.
  const tinyxml2::XMLElement* find(const std::string& id) const;
  /// @param around inherited style.
  SvgLook lookOf(const tinyxml2::XMLElement& e, const SvgLook& around);

 private:
  SvgDeclarations declarationsOf(const tinyxml2::XMLElement& e) const;
  SvgPaint paintOf(const tinyxml2::XMLElement& e, const std::string& name, const std::string& value,
                   const SvgPaint& otherwise);
  std::optional<SvgColor> gradientColor(const tinyxml2::XMLElement& user, const std::string& id, int depth);
  double opacityOf(const tinyxml2::XMLElement& e, const std::string& name, const std::string& value,
                   double otherwise);

  SvgReport& report_;
  SvgStyleSheet sheet_;
  std::map<std::string, const tinyxml2::XMLElement*> by_id_;
};

}  // namespace vismem
