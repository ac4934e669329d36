#include "simulator/core/svg_drawing.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/config/config_error.h"
#include "simulator/core/svg_path.h"
#include "simulator/core/svg_report.h"
#include "simulator/core/xml_error.h"

namespace vismem {
namespace {

using Eigen::Affine2d;
using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using tinyxml2::XMLElement;

constexpr double kFarthest_m = 1e5;
constexpr double kVisibleOpacity = 0.5;

/// Transform from user units to metres in the world, and inherited style.
struct Place {
  Affine2d T = Affine2d::Identity();
  SvgLook look;
};

class Reader {
 public:
  Reader(const std::string& file, const SvgOptions& options) : report_(file), options_(options) {}

  SvgDrawing read(const std::string& bytes) {
    tinyxml2::XMLDocument document;
    if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
      const int line = document.ErrorLineNum();
      throw ConfigError({report_.file() + (line > 0 ? ":" + std::to_string(line) : "") + ": not XML: " +
                         xmlErrorInWords(document.ErrorName()) + " (must be a drawing in SVG)"});
    }
    const XMLElement* root = document.RootElement();
    if (root == nullptr || svgNameOf(*root) != "svg") {
      throw ConfigError({report_.file() +
                         (root == nullptr ? ": no XML element"
                                          : ":" + std::to_string(root->GetLineNum()) +
                                                ": begins with the element <" + root->Name() + ">") +
                         " (must be a drawing in SVG)"});
    }
    if (const auto T = placeOf(*root)) drawChildren(*root, {*T, svgLookOf(*root, {}, report_)});
    refuseStyleSheets(*root);
    if (!report_.problems().empty()) throw ConfigError(report_.problems());
    drawing_.warnings = report_.warnings();
    return std::move(drawing_);
  }

 private:
  // --- reading of attributes ---
  std::optional<SvgLength> length(const XMLElement& e, const char* name) {
    const char* text = e.Attribute(name);
    if (text == nullptr) return std::nullopt;
    auto result = parseSvgLength(text);
    if (!result) report_.wrong(e, name, text, "a number, maybe with px, mm, cm, in, pt, pc, Q or %");
    return result;
  }
  double units(const XMLElement& e, const char* name, double hundred_percent) {
    const auto result = length(e, name);
    return result ? result->units(hundred_percent) : 0.0;
  }
  /// A length that must not be negative.
  double extent(const XMLElement& e, const char* name, double hundred_percent) {
    const double result = units(e, name, hundred_percent);
    if (result >= 0.0) return result;
    report_.wrong(e, name, e.Attribute(name), "0 or more");
    return 0.0;
  }
  Vector2d point(const XMLElement& e, const char* x, const char* y) {
    return {units(e, x, hundred_percent_.x()), units(e, y, hundred_percent_.y())};
  }
  Vector2d size(const XMLElement& e, const char* x, const char* y) {
    return {extent(e, x, hundred_percent_.x()), extent(e, y, hundred_percent_.y())};
  }

  std::optional<AlignedBox2d> viewBoxOf(const XMLElement& e) {
    const char* text = e.Attribute("viewBox");
    if (text == nullptr) return std::nullopt;
    std::vector<double> n;
    try {
      n = parseSvgNumbers(text);
    } catch (const std::invalid_argument&) {
    }
    if (n.size() == 4 && n[2] > 0.0 && n[3] > 0.0) {
      const Vector2d corner(n[0], n[1]);
      return AlignedBox2d(corner, corner + Vector2d(n[2], n[3]));
    }
    report_.wrong(e, "viewBox", text, "four numbers, the last two above 0");
    return std::nullopt;
  }
  /// Of maps that were written as drawings.
  std::optional<Vector2d> originOf(const XMLElement& root) {
    const char* text = root.Attribute("data-origin");
    if (text == nullptr) return std::nullopt;
    std::vector<double> n;
    try {
      n = parseSvgNumbers(text);
    } catch (const std::invalid_argument&) {
    }
    if (n.size() == 2) return Vector2d(n[0], n[1]);
    report_.wrong(root, "data-origin", text, "two numbers: x and y of the world's origin");
    return std::nullopt;
  }
  Affine2d transformOf(const XMLElement& e) {
    const std::string value = svgText(e, "transform");
    if (value.empty() || value == "none") return Affine2d::Identity();
    try {
      return parseSvgTransform(value);
    } catch (const std::invalid_argument& error) {
      report_.wrong(e, "transform", value, std::string("a list of transforms, but ") + error.what());
      return Affine2d::Identity();
    }
  }

  // --- the whole drawing ---
  /// Without its style sheets a drawing would have other colours.
  void refuseStyleSheets(const XMLElement& e) {
    if (svgNameOf(e) == "style" && e.GetText() != nullptr) {
      report_.problem(e, "style sheets are not supported (must be attributes or style=\"\" of each element)");
    }
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      refuseStyleSheets(*child);
    }
  }

  /// Size and position of the drawing in the world; empty, with a problem, if either is not defined.
  std::optional<Affine2d> placeOf(const XMLElement& root) {
    auto box = viewBoxOf(root);
    const auto width = length(root, "width");
    const auto height = length(root, "height");
    if (!report_.problems().empty()) return std::nullopt;
    const bool sized = width && height && width->unit != "%" && height->unit != "%" && width->value > 0.0 &&
                       height->value > 0.0;
    const Vector2d size = sized ? Vector2d(width->units(0.0), height->units(0.0)) : Vector2d(0, 0);
    if (!box && sized) box = AlignedBox2d(Vector2d(0, 0), size);
    Vector2d scale(1.0, 1.0);
    if (options_.metres_per_unit) {
      scale *= *options_.metres_per_unit;
    } else if (sized && width->isPhysical() && height->isPhysical()) {
      scale = size.cwiseQuotient(box->sizes());
      const std::string aspect = svgText(root, "preserveAspectRatio");
      if (aspect.find("slice") != std::string::npos) scale.setConstant(scale.maxCoeff());
      if (aspect.find("none") == std::string::npos) scale.setConstant(scale.minCoeff());
      scale *= kSvgPixel_m * options_.scale;
    } else {
      report_.problem(
          root, "width and height = \"" + svgText(root, "width") + "\" and \"" + svgText(root, "height") +
                    "\" (must be lengths in mm, cm or in, or the metres of a unit must be stated)");
      return std::nullopt;
    }
    const auto stated = originOf(root);
    if (!report_.problems().empty()) return std::nullopt;
    if (!options_.origin && !stated && !box) {
      report_.problem(
          root, "has neither a viewBox nor a width and height: where the world's origin lies must be stated");
      return std::nullopt;
    }
    const Vector2d origin =
        options_.origin ? *options_.origin : (stated ? *stated : Vector2d(box->min().x(), box->max().y()));
    if (box) hundred_percent_ = box->sizes();
    Affine2d T = Affine2d::Identity();
    T.linear().diagonal() = Vector2d(scale.x(), -scale.y());
    T.translation() = -(T.linear() * origin);
    return T;
  }

  // --- elements ---
  void drawChildren(const XMLElement& e, const Place& place) {
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      draw(*child, place);
    }
  }

  void draw(const XMLElement& e, const Place& around) {
    // They paint nothing by themselves.
    static const std::set<std::string> kSilent{
        "defs",     "symbol", "title",  "desc",           "metadata",       "style",           "script",
        "clipPath", "mask",   "marker", "linearGradient", "radialGradient", "filter",          "pattern",
        "animate",  "set",    "view",   "cursor",         "animateMotion",  "animateTransform"};
    const std::string name = svgNameOf(e);
    if (kSilent.contains(name) || name.find(':') != std::string::npos || report_.isFull()) return;
    if (name == "use" || name == "svg") {
      report_.problem(e, name == "use" ? "copies are not supported (must be unlinked: drawn in full)"
                                       : "drawings within drawings are not supported (must be groups)");
      return;
    }
    Place place{around.T, svgLookOf(e, around.look, report_)};
    if (place.look.opacity < kVisibleOpacity) return;
    place.T = around.T * transformOf(e);
    if (name == "g" || name == "a" || name == "switch") {
      drawChildren(e, place);
    } else if (const auto path = pathOf(e, name)) {
      paint(e, *path, place);
    } else {
      report_.leftOut(e, "<" + name + "> is left out");
    }
  }

  /// The outline of a shape; empty for what is no shape.
  std::optional<SvgPath> pathOf(const XMLElement& e, const std::string& name) {
    if (name == "rect") return rectangleOf(e);
    if (name == "circle" || name == "ellipse") {
      const Vector2d radii =
          name == "ellipse" ? size(e, "rx", "ry")
                            : Vector2d::Constant(extent(e, "r", hundred_percent_.norm() / std::sqrt(2.0)));
      return radii.minCoeff() > 0.0 ? svgEllipse(point(e, "cx", "cy"), radii) : SvgPath{};
    }
    if (name == "line") return svgPolyline({point(e, "x1", "y1"), point(e, "x2", "y2")}, false);
    if (name != "path" && name != "polyline" && name != "polygon") return std::nullopt;
    const char* attribute = name == "path" ? "d" : "points";
    const std::string data = svgText(e, attribute);
    try {
      if (name == "path") return parseSvgPath(data);
      const auto numbers = parseSvgNumbers(data);
      if (numbers.size() % 2 != 0) throw std::invalid_argument("has an odd number of numbers");
      SvgPoints points;
      for (std::size_t i = 0; i < numbers.size(); i += 2) points.emplace_back(numbers[i], numbers[i + 1]);
      return svgPolyline(points, name == "polygon");
    } catch (const std::invalid_argument& error) {
      report_.problem(e, std::string(attribute) + " " + error.what());
      return SvgPath{};
    }
  }
  SvgPath rectangleOf(const XMLElement& e) {
    const Vector2d sides = size(e, "width", "height");
    if (!(sides.minCoeff() > 0.0)) return {};
    const Vector2d radii = size(e, "rx", "ry");
    // A missing radius equals the other one.
    return svgRectangle(point(e, "x", "y"), sides,
                        {radii.x() > 0.0 ? radii.x() : radii.y(), radii.y() > 0.0 ? radii.y() : radii.x()});
  }

  /// @return empty, with a problem, if the points are too far or too many.
  std::optional<DrawnRing> inWorld(const XMLElement& e, const SvgPoints& points, const Affine2d& T) {
    points_ += points.size();
    if (points_ > options_.max_points) {
      if (!too_many_)
        report_.problem(
            e, "here the outlines have more than " + std::to_string(options_.max_points) + " corners");
      too_many_ = true;
      return std::nullopt;
    }
    DrawnRing ring;
    for (const auto& p : points) {
      ring.emplace_back(T * p);
      if (ring.back().allFinite() && ring.back().cwiseAbs().maxCoeff() <= kFarthest_m) continue;
      report_.problem(e, "lies farther than 100 km from the origin");
      return std::nullopt;
    }
    return ring;
  }

  void reportJoinsAndCaps(const XMLElement& e, const SvgLook& look) {
    if (look.join != "miter") report_.leftOut(e, "stroke-linejoin " + look.join + " is drawn as miter");
    if (look.cap != "butt") report_.leftOut(e, "stroke-linecap " + look.cap + " is drawn as butt");
  }

  void paint(const XMLElement& e, const SvgPath& path, const Place& place) {
    const SvgLook& look = place.look;
    if (!look.visible) return;
    const auto seen = [&](const SvgPaint& paint, double opacity) -> std::optional<SvgColor> {
      if (look.opacity * opacity < kVisibleOpacity) return std::nullopt;
      return paint.color;
    };
    const auto fill = seen(look.fill, look.fill_opacity);
    const auto stroke = seen(look.stroke, look.stroke_opacity);
    if (!fill && !stroke && look.label.empty()) return;
    // Of a stroke on a scaled element; the band itself is transformed exactly.
    const double width_m =
        look.fixed_width ? 0.0 : look.pen.width * std::sqrt(std::abs(place.T.linear().determinant()));
    DrawnShape inside{{}, look.even_odd, fill.value_or(SvgColor{})};
    DrawnShape band{{}, false, stroke.value_or(SvgColor{})};
    std::vector<DrawnLine> lines;
    for (const SvgSubpath& subpath : path) {
      const SvgPoints points = flattenSvg(subpath, place.T, options_.flatness_m);
      if (points.size() < 2) continue;
      auto ring = inWorld(e, points, place.T);
      if (!ring) return;
      if (look.label.empty() && stroke && width_m >= kWidestPen_m) {
        for (const auto& piece : strokeSvg(points, subpath.closed, look.pen)) {
          auto drawn = inWorld(e, piece, place.T);
          if (!drawn) return;
          band.rings.push_back(std::move(*drawn));
        }
        reportJoinsAndCaps(e, look);
      } else if (stroke || !look.label.empty()) {
        const bool closed = subpath.closed || (!stroke && fill && points.size() > 2);
        lines.push_back({*ring, closed, band.color, stroke ? width_m : 0.0, look.label, report_.where(e), 0});
      }
      if (points.size() > 2) inside.rings.push_back(std::move(*ring));
    }
    if (!look.label.empty()) {
      std::move(lines.begin(), lines.end(), std::back_inserter(drawing_.labelled));
      return;
    }
    if (fill && !inside.rings.empty()) drawing_.shapes.push_back(std::move(inside));
    if (!band.rings.empty()) drawing_.shapes.push_back(std::move(band));
    for (auto& line : lines) {
      line.above = drawing_.shapes.size();
      drawing_.pens.push_back(std::move(line));
    }
  }

  SvgReport report_;
  const SvgOptions& options_;
  SvgDrawing drawing_;
  Vector2d hundred_percent_ = Vector2d::Zero();  ///< size of the drawing, in user units
  std::size_t points_ = 0;
  bool too_many_ = false;
};

}  // namespace

SvgDrawing parseSvgDrawing(const std::string& bytes, const std::string& file, const SvgOptions& options) {
  return Reader(file, options).read(bytes);
}

}  // namespace vismem
