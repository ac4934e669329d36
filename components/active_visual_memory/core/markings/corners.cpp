#include "active_visual_memory/core/markings/corners.h"

#include <algorithm>

namespace vismem {

void joinAtCorners(std::vector<MemorySegment>& segments, std::span<const MemoryElement> elements,
                   const CornerParams& params) {
  std::vector<CornerEdge> edges;
  for (MemorySegment& segment : segments) {
    if (!segment.confirmed) continue;
    const MemoryElement* element = findElement(elements, segment.id);
    if (!element) continue;
    edges.push_back(cornerEdge(segment, *element));
  }
  std::vector<EdgeCorner> corners;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      EdgeCorner corner;
      if (i == k || !findCorner(edges[i], edges[k], params, corner)) continue;
      corner.from = i;
      corner.to = k;
      corners.push_back(corner);
    }
  }
  // The nearest first; an end has one corner.
  std::stable_sort(corners.begin(), corners.end(),
                   [](const EdgeCorner& a, const EdgeCorner& b) { return a.distance_m < b.distance_m; });
  std::vector<bool> ended(edges.size(), false);
  std::vector<bool> begun(edges.size(), false);
  for (const EdgeCorner& corner : corners) {
    if (ended[corner.from] || begun[corner.to]) continue;
    ended[corner.from] = begun[corner.to] = true;
    const Eigen::Vector3d place{corner.place.x(), corner.place.y(), 0.0};
    edges[corner.from].published->odom.b = place;
    edges[corner.to].published->odom.a = place;
  }
}

}  // namespace vismem
