#include "active_visual_memory/core/markings/shape_edges.h"

#include <algorithm>

namespace vismem {

void ShapeEdges::Params::visit(ParameterVisitor& v) {
  v.real(basic("Line.MinimumWidth_m", "width of line markings; a measured width may be a third less"),
         line_width.min_m, 0.001, 5.0);
  v.real(basic("Line.MaximumWidth_m", "the same, at most"), line_width.max_m, 0.001, 5.0);
  v.require("Line.MinimumWidth_m", line_width.min_m < line_width.max_m, "must be less than",
            "Line.MaximumWidth_m");
  bool far_lines = false;
  v.flag(expert("FarLines",
                "for distant narrow lines: ends within two sigmas of their corner, junctions by one edge of "
                "a line, cross spots"),
         far_lines);
  if (far_lines) {
    // Distant ends are uncertain by two pixels instead of one.
    corners.reach.sigmas = junctions.reach.sigmas = 2.0;
    corners.reach.most_m = junctions.reach.most_m = 0.25;
    junctions.by_one_side = true;
    crosses.enabled = true;
  }
  v.alias("PartAtJunctions", "SplitAtJunctions");
  v.flag(expert("SplitAtJunctions", "split edges where lines join or cross"), junctions.enabled);
}

ShapeEdges::ShapeEdges(const Params& params) : params_(params) {
  params_.line_widths.range = params_.junctions.range = params_.line_width;
}

std::uint64_t ShapeEdges::idOf(const Key& key) {
  const auto known = std::ranges::lower_bound(ids_, key, {}, &Ids::value_type::first);
  const bool is_known = known != ids_.end() && known->first == key;
  return used_.emplace_back(key, is_known ? known->second : (*new_id_)()).second;
}

void ShapeEdges::complete(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                          std::vector<Primitive>& primitives, const NewId& new_id) {
  if (!params_.enabled) return;
  scratch_.release();
  std::pmr::memory_resource* const scratch = scratch_.resource();
  const auto edges = [&] { return publishedEdges(segments, elements, scratch); };
  used_.clear();
  new_id_ = &new_id;
  const LineWidths widths = measureLineWidths(edges(), params_.line_widths, scratch);
  for (Primitive& primitive : primitives) {
    if (primitive.kind != PrimitiveKind::kCircle) continue;
    const auto id = [this, circle = primitive.id](int chord, int edge) {
      return idOf({circle, static_cast<std::uint64_t>(chord), edge});
    };
    regularizeCircle(segments, primitive, widths, params_.circles, id, scratch);
  }
  if (params_.crosses.enabled) {
    const auto id = [this](std::uint64_t oldest, int n) { return idOf({oldest, 1, -2 - n}); };
    replaceCrossSpots(segments, edges(), widths, params_.dominant_direction, params_.crosses, id, scratch);
  }
  closeLineEnds(
      segments, edges(), params_.line_width,
      [this](std::uint64_t one, std::uint64_t other) {
        return idOf({one, other, -1});
      },
      scratch);
  if (params_.junctions.enabled) {
    const auto id = [this](std::uint64_t whole, int part) { return idOf({whole, 0, -2 - part}); };
    splitAtJunctions(segments, edges(), primitives, widths, params_.junctions, id, scratch);
  }
  joinAtCorners(edges(), params_.corners, scratch);
  // An edge that returns after an absence gets a new id.
  ids_.swap(used_);
  std::ranges::sort(ids_);
}

}  // namespace vismem
