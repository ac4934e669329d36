#include "active_visual_memory/core/markings/line_marking.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

bool mayBePaint(const PublishedEdge& edge) {
  return edge.element && !edge.element->plane.stands && edge.published->label != kUnknownLabel;
}

bool isNear(const PublishedEdge& edge, const LineWidthParams& params) {
  const FloorLine& line = edge.element->line;
  return edge.confirmed() &&
         std::min(line.endA().best_m2, line.endB().best_m2) <= params.near_sigma_m * params.near_sigma_m;
}

}  // namespace

std::optional<Neighbourhood> lineMarking(const PublishedEdge& one, const PublishedEdge& other,
                                         double max_width_m, double min_strength_share) {
  if (one.published->label != other.published->label) return std::nullopt;
  const auto [weak, strong] = std::minmax(one.element->strength, other.element->strength);
  if (weak < min_strength_share * strong) return std::nullopt;
  const auto beside = antiparallel(one.line, other.line);
  return beside && beside->distance_m <= max_width_m ? beside : std::nullopt;
}

LineWidths measureLineWidths(std::span<const PublishedEdge> edges, const LineWidthParams& params,
                             std::pmr::memory_resource* scratch) {
  LineWidths known(scratch);
  std::pmr::vector<PublishedEdge> near(scratch);
  std::copy_if(edges.begin(), edges.end(), std::back_inserter(near),
               [&](const PublishedEdge& edge) { return mayBePaint(edge) && isNear(edge, params); });
  std::pmr::map<Label, std::pmr::vector<double>> measured(scratch);
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (std::size_t k = i + 1; k < near.size(); ++k) {
      const auto beside = lineMarking(near[i], near[k], params.range.max_m);
      // Short pairs are spots, not lines.
      if (!beside || beside->distance_m < params.range.minMeasured_m() ||
          beside->overlap_m() < params.min_overlap * std::min(near[i].length(), near[k].length()) ||
          beside->overlap_m() < params.least_length_widths * beside->distance_m) {
        continue;
      }
      measured[near[i].published->label].push_back(beside->left_m);
    }
  }
  for (auto& [label, widths] : measured) {
    std::sort(widths.begin(), widths.end());
    const double median = widths[widths.size() / 2];
    const auto agreeing = std::count_if(widths.begin(), widths.end(), [&](double width) {
      return std::abs(width - median) <= params.agree_m;
    });
    if (static_cast<double>(agreeing) >= params.agree_share * static_cast<double>(widths.size())) {
      known[label] = median;
    }
  }
  return known;
}

}  // namespace vismem
