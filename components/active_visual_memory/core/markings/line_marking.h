/// @file Line markings: two antiparallel edges side by side, and their width. Pure. See M9.
#pragma once

#include <map>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/memory/duplicates.h"
#include "active_visual_memory/core/memory/published_edge.h"
#include "common/geometry/segment.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Whether two edges with elements are those of one line marking: antiparallel, side by side, of one label,
/// and alike in contrast, unlike those of a shadow.
/// @param min_strength_share  contrast of the weaker edge over that of the stronger one.
std::optional<Neighbourhood> lineMarking(const PublishedEdge& one, const PublishedEdge& other,
                                         double max_width_m, double min_strength_share = 0.0);

/// The widths that line markings may have: one value for all that pair edges.
struct LineWidthRange {
  double min_m = 0.03;
  double max_m = 0.13;

  /// Least measured width: edges of distant lines are measured up to a third closer, where blur puts them.
  double minMeasured_m() const { return 2.0 * min_m / 3.0; }
};

/// Line markings of one label have one width. It is measured at near lines: that of distant ones is below the
/// resolution of the image.
struct LineWidthParams {
  LineWidthRange range;
  double min_overlap = 0.5;          ///< of the shorter edge
  double near_sigma_m = 0.02;        ///< sigma of an end of both edges up to which a line is near
  double least_length_widths = 3.0;  ///< least length of a measured line, in widths: shorter ones are spots
  double agree_m = 0.015;            ///< distance from the median within which widths agree
  double agree_share = 0.7;          ///< of the widths of a label that must agree
};

/// Signed widths by label: > 0 if the paint lies to the left of both edges (a bright line), < 0 to the right.
using LineWidths = std::pmr::map<Label, double>;

/// @return widths of near lines by label.
LineWidths measureLineWidths(std::span<const PublishedEdge> edges, const LineWidthParams& params,
                             std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
