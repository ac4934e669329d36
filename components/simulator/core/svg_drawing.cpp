#include "simulator/core/svg_drawing.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/config/config_error.h"
#include "simulator/core/svg_look.h"
#include "simulator/core/svg_path.h"
#include "simulator/core/svg_report.h"
#include "simulator/core/xml_error.h"

namespace vismem {
namespace {

using Eigen::Affine2d;
using Eigen::Vector2d;
using tinyxml2::XMLElement;

/// Limits of nested `use` elements and of drawn elements, against files with endless recursion.
constexpr int kMaxUses = 16;
constexpr std::size_t kMaxElements = 50'000;
constexpr double kFarthest_m = 1e5;
constexpr double kVisibleOpacity = 0.5;

/// Transform and viewport of an element.
struct Place {
  Affine2d T = Affine2d::Identity();  ///< from user units to metres in the world
  Vector2d hundred_percent = Vector2d::Zero();
  SvgLook look;
  int uses = 0;
};

struct ViewBox {
  Vector2d corner = Vector2d::Zero();
  Vector2d size = Vector2d::Zero();
};

/// Transform from a view box to a viewport of that size, by preserveAspectRatio.
Affine2d fit(const ViewBox& box, const Vector2d& size, const std::string& aspect) {
  Vector2d scale = size.cwiseQuotient(box.size);
  Vector2d share(0.5, 0.5);
  if (aspect.find("none") == std::string::npos) {
    const double one = aspect.find("slice") == std::string::npos ? scale.minCoeff() : scale.maxCoeff();
    scale = Vector2d(one, one);
    if (aspect.find("xMin") != std::string::npos) share.x() = 0.0;
    if (aspect.find("xMax") != std::string::npos) share.x() = 1.0;
    if (aspect.find("YMin") != std::string::npos) share.y() = 0.0;
    if (aspect.find("YMax") != std::string::npos) share.y() = 1.0;
  }
  Affine2d T = Affine2d::Identity();
  T.linear().diagonal() = scale;
  T.translation() =
      (size - scale.cwiseProduct(box.size)).cwiseProduct(share) - scale.cwiseProduct(box.corner);
  return T;
}

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
    looks_.collect(*root);
    Place place;
    if (placeRoot(*root, place)) {
      place.look = looks_.lookOf(*root, place.look);
      drawChildren(*root, place);
    }
    if (!report_.problems().empty()) throw ConfigError(report_.problems());
    drawing_.warnings = report_.warnings();
    return std::move(drawing_);
  }

 private:
  // --- reading of attributes ---
  std::optional<SvgLength> length(const XMLElement& e, const char* name) {
    const char* text = e.Attribute(name);
    if (text == nullptr || std::string_view(text) == "auto") return std::nullopt;
    auto result = parseSvgLength(text);
    if (!result) report_.wrong(e, name, text, "a number, maybe with px, mm, cm, in, pt, pc, Q or %");
    return result;
  }
  double units(const XMLElement& e, const char* name, double hundred_percent, double otherwise = 0.0) {
    const auto result = length(e, name);
    return result ? result->units(hundred_percent) : otherwise;
  }
  /// A length that must not be negative.
  double extent(const XMLElement& e, const char* name, double hundred_percent, double otherwise = 0.0) {
    const double result = units(e, name, hundred_percent, otherwise);
    if (result >= 0.0) return result;
    report_.wrong(e, name, e.Attribute(name), "0 or more");
    return 0.0;
  }
  static double diagonal(const Place& place) { return place.hundred_percent.norm() / std::sqrt(2.0); }

  std::optional<ViewBox> viewBoxOf(const XMLElement& e) {
    const char* text = e.Attribute("viewBox");
    if (text == nullptr) return std::nullopt;
    std::vector<double> n;
    try {
      n = parseSvgNumbers(text);
    } catch (const std::invalid_argument&) {
    }
    if (n.size() == 4 && n[2] > 0.0 && n[3] > 0.0) return ViewBox{{n[0], n[1]}, {n[2], n[3]}};
    report_.wrong(e, "viewBox", text, "four numbers, the last two above 0");
    return std::nullopt;
  }
  static std::string aspectOf(const XMLElement& e) {
    const char* text = e.Attribute("preserveAspectRatio");
    return text == nullptr ? "" : text;
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

  // --- places ---
  /// Size and position of the drawing.
  /// @return whether both are defined.
  bool placeRoot(const XMLElement& root, Place& place) {
    auto box = viewBoxOf(root);
    const auto width = length(root, "width");
    const auto height = length(root, "height");
    if (!report_.problems().empty()) return false;
    const bool sized = width && height && width->unit != "%" && height->unit != "%" && width->value > 0.0 &&
                       height->value > 0.0;
    const Vector2d size = sized ? Vector2d(width->units(0.0), height->units(0.0)) : Vector2d(0, 0);
    if (!box && sized) box = ViewBox{{0, 0}, size};
    Vector2d scale(1.0, 1.0);
    if (options_.metres_per_unit) {
      scale *= *options_.metres_per_unit;
    } else if (sized && width->isPhysical() && height->isPhysical()) {
      scale = fit(*box, size, aspectOf(root)).linear().diagonal() * kSvgPixel_m * options_.scale;
    } else {
      report_.problem(
          root, "width and height = \"" + svgText(root, "width") + "\" and \"" + svgText(root, "height") +
                    "\" (must be lengths in mm, cm or in, or the metres of a unit must be stated)");
      return false;
    }
    if (!options_.origin && !box) {
      report_.problem(
          root, "has neither a viewBox nor a width and height: where the world's origin lies must be stated");
      return false;
    }
    const Vector2d origin =
        options_.origin ? *options_.origin : Vector2d(box->corner.x(), box->corner.y() + box->size.y());
    place.T.linear().diagonal() = Vector2d(scale.x(), -scale.y());
    place.T.translation() = -(place.T.linear() * origin);
    place.hundred_percent = box ? box->size : Vector2d(0, 0);
    return true;
  }
  void drawChildren(const XMLElement& e, const Place& place) {
    for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      draw(*child, place);
    }
  }

  /// The inside of svg and symbol.
  /// @param size of its viewport.
  void drawViewport(const XMLElement& e, Place place, const Vector2d& corner, const Vector2d& size) {
    place.T = place.T * Eigen::Translation2d(corner);
    if (const auto box = viewBoxOf(e)) {
      if (!(size.minCoeff() > 0.0)) return;
      place.T = place.T * fit(*box, size, aspectOf(e));
      place.hundred_percent = box->size;
    } else {
      place.hundred_percent = size;
    }
    drawChildren(e, place);
  }

  void drawUse(const XMLElement& e, Place place) {
    const XMLElement* target = looks_.find(svgLinkOf(e));
    if (target == nullptr) {
      report_.wrong(e, "href", svgText(e, "href") + svgText(e, "xlink:href"),
                    "# and the id of an element of this file");
      return;
    }
    if (++place.uses > kMaxUses) {
      report_.problem(e, "uses #" + svgLinkOf(e) + " too deep, or within itself");
      return;
    }
    const Vector2d full = place.hundred_percent;
    const Vector2d corner(units(e, "x", full.x()), units(e, "y", full.y()));
    if (svgNameOf(*target) == "symbol") {
      place.look = looks_.lookOf(*target, place.look);
      drawViewport(*target, place, corner,
                   {extent(e, "width", full.x(), full.x()), extent(e, "height", full.y(), full.y())});
    } else {
      place.T = place.T * Eigen::Translation2d(corner);
      draw(*target, place);
    }
  }

  // --- elements ---
  void draw(const XMLElement& e, const Place& around) {
    static const std::set<std::string> kSilent{
        "defs",     "symbol", "title",  "desc",           "metadata",       "style",           "script",
        "clipPath", "mask",   "marker", "linearGradient", "radialGradient", "filter",          "pattern",
        "animate",  "set",    "view",   "cursor",         "animateMotion",  "animateTransform"};
    const std::string name = svgNameOf(e);
    if (kSilent.contains(name) || name.find(':') != std::string::npos || report_.isFull()) return;
    if (++elements_ > kMaxElements) {
      if (elements_ == kMaxElements + 1) report_.problem(e, "more than 50000 elements are drawn");
      return;
    }
    Place place = around;
    place.look = looks_.lookOf(e, around.look);
    if (place.look.opacity < kVisibleOpacity) return;
    place.T = around.T * transformOf(e);
    const Vector2d full = place.hundred_percent;
    if (name == "g" || name == "a" || name == "switch") {
      drawChildren(e, place);
    } else if (name == "svg") {
      drawViewport(e, place, {units(e, "x", full.x()), units(e, "y", full.y())},
                   {extent(e, "width", full.x(), full.x()), extent(e, "height", full.y(), full.y())});
    } else if (name == "use") {
      drawUse(e, place);
    } else if (const auto path = pathOf(e, name, place)) {
      paint(e, *path, place);
    } else {
      report_.leftOut(e, "<" + name + "> is left out");
    }
  }

  /// The outline of a shape; empty for what is no shape.
  std::optional<SvgPath> pathOf(const XMLElement& e, const std::string& name, const Place& place) {
    const Vector2d full = place.hundred_percent;
    const auto point = [&](const char* x, const char* y) {
      return Vector2d(units(e, x, full.x()), units(e, y, full.y()));
    };
    if (name == "rect") {
      const Vector2d size(extent(e, "width", full.x()), extent(e, "height", full.y()));
      if (!(size.minCoeff() > 0.0)) return SvgPath{};
      // A missing radius equals the other one.
      const double rx = extent(e, "rx", full.x());
      const double ry = extent(e, "ry", full.y());
      return svgRectangle(point("x", "y"), size, {rx > 0.0 ? rx : ry, ry > 0.0 ? ry : rx});
    }
    if (name == "circle" || name == "ellipse") {
      Vector2d radii = Vector2d::Constant(extent(e, "r", diagonal(place)));
      if (name == "ellipse") radii = {extent(e, "rx", full.x()), extent(e, "ry", full.y())};
      if (!(radii.minCoeff() > 0.0)) return SvgPath{};
      return svgEllipse(point("cx", "cy"), radii);
    }
    if (name == "line") return svgPolyline({point("x1", "y1"), point("x2", "y2")}, false);
    const char* attribute = name == "path"                            ? "d"
                            : name == "polyline" || name == "polygon" ? "points"
                                                                      : nullptr;
    if (attribute == nullptr) return std::nullopt;
    const char* data = e.Attribute(attribute);
    if (data == nullptr) return SvgPath{};
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

  void paint(const XMLElement& e, const SvgPath& path, const Place& place) {
    const SvgLook& look = place.look;
    if (!look.visible) return;
    const auto seen = [&](const SvgPaint& paint, double opacity) -> std::optional<SvgColor> {
      if (look.opacity * opacity < kVisibleOpacity) return std::nullopt;
      return paint.current ? look.color : paint.color;
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
  SvgLooks looks_{report_};
  SvgDrawing drawing_;
  std::size_t elements_ = 0;
  std::size_t points_ = 0;
  bool too_many_ = false;
};

}  // namespace

SvgDrawing parseSvgDrawing(const std::string& bytes, const std::string& file, const SvgOptions& options) {
  return Reader(file, options).read(bytes);
}

}  // namespace vismem
