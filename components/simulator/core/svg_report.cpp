#include "simulator/core/svg_report.h"

#include <tinyxml2.h>

namespace vismem {

using tinyxml2::XMLElement;

std::string svgNameOf(const XMLElement& element) {
  std::string name = element.Name();
  if (name.starts_with("svg:")) name.erase(0, 4);
  return name;
}

std::string svgText(const XMLElement& element, const char* attribute) {
  const char* value = element.Attribute(attribute);
  return value == nullptr ? "" : value;
}

std::string SvgReport::where(const XMLElement& e) const {
  const std::string id = svgText(e, "id");
  return file_ + ":" + std::to_string(e.GetLineNum()) + ": <" + svgNameOf(e) +
         (id.empty() ? "" : " id=\"" + id + "\"") + ">";
}

void SvgReport::problem(const XMLElement& e, const std::string& what) {
  if (!isFull()) problems_.push_back(where(e) + ": " + what);
}

void SvgReport::wrong(const XMLElement& e, const std::string& name, const std::string& value,
                      const std::string& rule) {
  problem(e, name + " = \"" + value + "\" (must be " + rule + ")");
}

void SvgReport::leftOut(const XMLElement& e, const std::string& what) {
  ++left_out_.try_emplace(what, e.GetLineNum(), 0).first->second.second;
}

std::vector<std::string> SvgReport::warnings() const {
  std::vector<std::string> result;
  for (const auto& [what, seen] : left_out_) {
    result.push_back(file_ + ":" + std::to_string(seen.first) + ": " + what +
                     (seen.second > 1 ? " (" + std::to_string(seen.second) + " times)" : ""));
  }
  return result;
}

}  // namespace vismem
