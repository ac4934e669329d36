#include "active_visual_memory/core/markings/shape_edges.h"

namespace vismem {

void ShapeEdges::Params::visit(ParameterVisitor& v) {
  v.real(basic("Line.MinimumWidth_m", "width of line markings; a measured width may be a third less"),
         line_width.min_m, 0.001, 5.0);
  v.real(basic("Line.MaximumWidth_m", "the same, at most"), line_width.max_m, 0.001, 5.0);
  v.require("Line.MinimumWidth_m", line_width.min_m < line_width.max_m, "must be less than",
            "Line.MaximumWidth_m");
  bool far_lines = false;
  v.flag(
      expert("FarLines",
             "for distant narrow lines: ends within two sigmas of their corner, edges a pixel further apart, "
             "junctions by one edge of a line, cross spots"),
      far_lines);
  if (far_lines) {
    // Distant ends are uncertain by two pixels instead of one.
    corners.reach.sigmas = junctions.reach.sigmas = 2.0;
    corners.reach.most_m = junctions.reach.most_m = 0.25;
    line_widths.blur_px = 1.0;
    junctions.by_one_side = true;
    crosses.enabled = true;
  }
  v.alias("PartAtJunctions", "SplitAtJunctions");
  v.flag(expert("SplitAtJunctions", "split edges where lines join or cross"), junctions.enabled);
  v.flag(expert("EvenLineWidths", "give distant lines the width of near ones of their label"),
         line_widths.enabled);
}

ShapeEdges::ShapeEdges(const Params& params) : params_(params) {
  params_.line_widths.range = params_.junctions.range = params_.line_width;
}

std::uint64_t ShapeEdges::idOf(const Key& key, const NewId& new_id) {
  const auto known = ids_.find(key);
  const std::uint64_t id = known != ids_.end() ? known->second : new_id();
  used_.emplace(key, id);
  return id;
}

void ShapeEdges::complete(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          std::vector<Primitive>& primitives, const NewId& new_id) {
  if (!params_.enabled) return;
  used_.clear();
  const LineWidths widths = measureLineWidths(publishedEdges(segments, elements), params_.line_widths);
  for (Primitive& primitive : primitives) {
    if (primitive.kind != PrimitiveKind::kCircle) continue;
    const std::uint64_t circle = primitive.id;
    regularizeCircle(segments, primitive, widths, params_.circles, [&](int chord, int edge) {
      return idOf({circle, static_cast<std::uint64_t>(chord), edge}, new_id);
    });
  }
  replaceCrossSpots(segments, publishedEdges(segments, elements), widths, params_.dominant_direction,
                    params_.crosses, [&](std::uint64_t oldest, int n) {
                      return idOf({oldest, 1, -2 - n}, new_id);
                    });
  closeLineEnds(segments, publishedEdges(segments, elements), params_.line_width,
                [&](std::uint64_t one, std::uint64_t other) {
                  return idOf({one, other, -1}, new_id);
                });
  equalizeLineWidths(publishedEdges(segments, elements), widths, params_.line_widths);
  splitAtJunctions(segments, publishedEdges(segments, elements), primitives, widths, params_.junctions,
                   [&](std::uint64_t whole, int part) {
                     return idOf({whole, 0, -2 - part}, new_id);
                   });
  joinAtCorners(publishedEdges(segments, elements), params_.corners);
  // An edge that returns after an absence gets a new id.
  ids_.swap(used_);
}

}  // namespace vismem
