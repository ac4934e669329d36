#include "simulator/core/svg_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/config/config_error.h"
#include "common/geometry/plane.h"
#include "simulator/core/map_builder_stripes.h"
#include "simulator/core/map_pieces.h"

namespace vismem {
namespace {

using Eigen::Vector2d;

/// Outlines nearer than this coincide.
constexpr double kSameLine_m = 1e-6;
constexpr double kMinStripe_m = 0.03;
constexpr double kMaxStripe_m = 0.12;
constexpr const char* kAnyLabel = "any";

/// A straight piece of an outline or of a thin stroke, and its intersections with others.
struct Edge {
  Vector2d a, b;
  int pen = -1;  ///< index of its pen; -1: of an outline
  std::vector<double> cuts;

  Vector2d at(double t) const { return a + t * (b - a); }
  double low() const { return std::min(a.x(), b.x()); }
  double high() const { return std::max(a.x(), b.x()); }
};

/// Cuts both at their intersection; coincident ones at the ends of either.
void cutEachOther(Edge& e, Edge& f) {
  const Vector2d de = e.b - e.a;
  const Vector2d df = f.b - f.a;
  const Vector2d r = f.a - e.a;
  const double across = cross2(de, df);
  if (std::abs(across) > 1e-9 * de.norm() * df.norm()) {
    const double t = cross2(r, df) / across;
    const double u = cross2(r, de) / across;
    const double slack_e = kSameLine_m / de.norm();
    const double slack_f = kSameLine_m / df.norm();
    if (t < -slack_e || t > 1.0 + slack_e || u < -slack_f || u > 1.0 + slack_f) return;
    e.cuts.push_back(t);
    f.cuts.push_back(u);
    return;
  }
  if (std::abs(cross2(r, de)) > kSameLine_m * de.norm()) return;
  e.cuts.push_back(r.dot(de) / de.squaredNorm());
  e.cuts.push_back((f.b - e.a).dot(de) / de.squaredNorm());
  f.cuts.push_back(-r.dot(df) / df.squaredNorm());
  f.cuts.push_back((e.b - f.a).dot(df) / df.squaredNorm());
}

/// Queries of the painted shapes at a place on the floor.
class Paint {
 public:
  Paint(const SvgDrawing& drawing, const Palette& palette, ColorClass ground)
      : drawing_(drawing), ground_(ground) {
    for (const auto& shape : drawing.shapes) {
      classes_.push_back(palette.classOf(shape.color[0], shape.color[1], shape.color[2]));
      Eigen::AlignedBox2d box;
      for (const auto& ring : shape.rings) {
        for (const auto& p : ring) box.extend(p);
      }
      boxes_.push_back(box);
    }
  }

  /// Index of the uppermost shape there; -1: none.
  int shapeAt(const Vector2d& p) const {
    for (std::size_t i = drawing_.shapes.size(); i-- > 0;) {
      if (boxes_[i].contains(p) && contains(drawing_.shapes[i], p)) return static_cast<int>(i);
    }
    return -1;
  }
  ColorClass classOf(int shape) const {
    return shape < 0 ? ground_ : classes_[static_cast<std::size_t>(shape)];
  }

 private:
  static bool contains(const DrawnShape& shape, const Vector2d& p) {
    int winding = 0;
    int crossings = 0;
    for (const auto& ring : shape.rings) {
      Vector2d a = ring.back();
      for (const Vector2d& b : ring) {
        if ((a.y() > p.y()) != (b.y() > p.y())) {
          // The outline crosses the level of p: to its right?
          const double side = cross2(b - a, p - a);
          const bool upwards = b.y() > a.y();
          if (upwards ? side > 0.0 : side < 0.0) {
            ++crossings;
            winding += upwards ? 1 : -1;
          }
        }
        a = b;
      }
    }
    return shape.even_odd ? crossings % 2 == 1 : winding != 0;
  }

  const SvgDrawing& drawing_;
  ColorClass ground_;
  std::vector<ColorClass> classes_;
  std::vector<Eigen::AlignedBox2d> boxes_;
};

class Mapper {
 public:
  Mapper(const SvgDrawing& drawing, const Palette& palette, const SvgMapParams& params, ColorClass ground)
      : drawing_(drawing), palette_(palette), params_(params), paint_(drawing, palette, ground) {}

  SegmentMap map() {
    std::vector<Edge> edges;
    for (const auto& shape : drawing_.shapes) {
      for (const auto& ring : shape.rings) addEdges(ring, true, -1, edges);
    }
    for (std::size_t i = 0; i < drawing_.pens.size(); ++i) {
      addEdges(drawing_.pens[i].points, drawing_.pens[i].closed, static_cast<int>(i), edges);
    }
    cut(edges);
    for (Edge& edge : edges) addPieces(edge);

    SegmentMap found;
    for (const auto& segment : joinPieces(pieces_, params_.same_place_m)) {
      if (segment.world.length() >= params_.min_length_m) found.segments.push_back(rounded(segment));
    }
    if (!palette_.stripes().empty()) found = joinStripes(found, palette_.stripes());
    addLabelled(found);
    return found;
  }

 private:
  static void addEdges(const std::vector<Vector2d>& points, bool closed, int pen, std::vector<Edge>& edges) {
    const std::size_t count = closed ? points.size() : points.size() - 1;
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2d& b = points[(i + 1) % points.size()];
      if ((b - points[i]).norm() > kSameLine_m) edges.push_back({points[i], b, pen, {}});
    }
  }

  static void cut(std::vector<Edge>& edges) {
    std::vector<Edge*> from_left;
    for (Edge& edge : edges) from_left.push_back(&edge);
    std::stable_sort(from_left.begin(), from_left.end(),
                     [](const Edge* x, const Edge* y) { return x->low() < y->low(); });
    for (std::size_t i = 0; i < from_left.size(); ++i) {
      Edge& e = *from_left[i];
      const double bottom = std::min(e.a.y(), e.b.y()) - kSameLine_m;
      const double top = std::max(e.a.y(), e.b.y()) + kSameLine_m;
      for (std::size_t j = i + 1; j < from_left.size() && from_left[j]->low() <= e.high() + kSameLine_m;
           ++j) {
        Edge& f = *from_left[j];
        if (std::min(f.a.y(), f.b.y()) <= top && std::max(f.a.y(), f.b.y()) >= bottom) cutEachOther(e, f);
      }
    }
  }

  std::optional<Label> labelOf(ColorClass a, ColorClass b) const {
    const Label& label = palette_.label(a, b);
    if (label == kUnknownLabel) return std::nullopt;
    return label;
  }

  /// The label at a place of an edge, from its two sides.
  std::optional<Label> labelAt(const Edge& edge, const Vector2d& left, const Vector2d& right) const {
    const int shape_left = paint_.shapeAt(left);
    const int shape_right = paint_.shapeAt(right);
    const ColorClass class_left = paint_.classOf(shape_left);
    const ColorClass class_right = paint_.classOf(shape_right);
    if (edge.pen < 0) return labelOf(class_left, class_right);
    const DrawnLine& pen = drawing_.pens[static_cast<std::size_t>(edge.pen)];
    const auto above = static_cast<int>(pen.above);
    if (shape_left >= above && shape_right >= above) return std::nullopt;  // painted over
    const ColorClass own = palette_.classOf(pen.color[0], pen.color[1], pen.color[2]);
    // Classes count in the order of the palette; none is 0.
    const auto [first, second] = std::minmax(class_left, class_right);
    const auto label = labelOf(own, first);
    return label ? label : labelOf(own, second);
  }

  void addPieces(Edge& edge) {
    auto& cuts = edge.cuts;
    cuts.push_back(0.0);
    cuts.push_back(1.0);
    for (double& t : cuts) t = std::clamp(t, 0.0, 1.0);
    std::sort(cuts.begin(), cuts.end());
    const double length = (edge.b - edge.a).norm();
    const Vector2d d = (edge.b - edge.a) / length;
    const Vector2d aside = params_.side_m * turned90(d);
    std::optional<Label> label;
    double from = 0.0;
    double to = 0.0;
    const auto flush = [&] {
      if (label) {
        const Vector2d a = edge.at(from);
        const Vector2d b = edge.at(to);
        pieces_.push_back({{{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}}, *label});
      }
    };
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      // Pieces shorter than the sampling distance would sample the colours beyond the next corner.
      if ((cuts[i] - cuts[i - 1]) * length <= 2.0 * params_.side_m) continue;
      const Vector2d middle = edge.at(0.5 * (cuts[i - 1] + cuts[i]));
      const auto here = labelAt(edge, middle + aside, middle - aside);
      if (here != label) {
        flush();
        label = here;
        from = cuts[i - 1];
      }
      to = cuts[i];
    }
    flush();
  }

  static MapSegment rounded(MapSegment segment) {
    for (Eigen::Vector3d* end : {&segment.world.a, &segment.world.b}) {
      // Rounded to millimetres for readability, without -0.
      *end = (*end * 1e3).array().round() / 1e3 + 0.0;
    }
    return segment;
  }

  /// Lines that the drawing labels itself.
  void addLabelled(SegmentMap& found) const {
    std::vector<std::string> problems;
    const auto labels = palette_.labels();
    for (const DrawnLine& line : drawing_.labelled) {
      const bool stripe = palette_.stripes().contains(line.label);
      if (!stripe && line.label != kAnyLabel &&
          std::find(labels.begin(), labels.end(), line.label) == labels.end()) {
        problems.push_back(line.where + ": data-label = \"" + line.label + "\" (must be " + known() + ")");
        continue;
      }
      const bool wide = line.width_m >= kMinStripe_m && line.width_m <= kMaxStripe_m;
      if (stripe && !wide) {
        problems.push_back(line.where + ": a stripe \"" + line.label + "\" of " +
                           std::to_string(line.width_m) + " m (must be a stroke of 0.03 to 0.12 m)");
        continue;
      }
      const std::size_t count = line.points.size() - (line.closed ? 0 : 1);
      for (std::size_t i = 0; i < count; ++i) {
        const Vector2d& a = line.points[i];
        const Vector2d& b = line.points[(i + 1) % line.points.size()];
        const double width = stripe ? std::round(line.width_m * 1e3) / 1e3 : 0.0;
        const MapSegment row = rounded({{{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}}, line.label, width});
        if (row.world.length() >= params_.min_length_m) found.segments.push_back(row);
      }
    }
    if (!problems.empty()) throw ConfigError(std::move(problems));
  }
  std::string known() const {
    std::string result = kAnyLabel;
    for (const auto& label : palette_.labels()) result += ", " + label;
    for (const auto& [name, edge] : palette_.stripes()) result += ", " + name;
    return result;
  }

  const SvgDrawing& drawing_;
  const Palette& palette_;
  const SvgMapParams& params_;
  Paint paint_;
  std::vector<MapSegment> pieces_;
};

}  // namespace

SvgMap buildSvgMap(const std::string& bytes, const std::string& file, const Palette& palette,
                   const SvgMapParams& params) {
  const ColorClass ground = params.ground.empty() ? kNoColorClass : palette.classNamed(params.ground);
  if (!params.ground.empty() && ground == kNoColorClass) {
    std::string names;
    for (int i = 1; i <= palette.classCount(); ++i) {
      names += (i == 1 ? "" : ", ") + palette.className(static_cast<ColorClass>(i));
    }
    throw ConfigError(
        {"ground = " + params.ground + " (must be a colour class of the palette: " + names + ")"});
  }
  SvgDrawing drawing = parseSvgDrawing(bytes, file, params.drawing);
  return {Mapper(drawing, palette, params, ground).map(), std::move(drawing.warnings)};
}

}  // namespace vismem
