#include "common/vision/segment_merge.h"

#include <map>

#include "common/vision/collinear_merge.h"

namespace vismem {

std::vector<ImageSegment> mergeSegments(std::vector<ImageSegment> segments, const MergeParams& params) {
  std::map<Label, int> group_of;
  for (const auto& segment : segments) group_of.try_emplace(segment.label, 0);
  std::vector<Label> labels;
  for (auto& [label, group] : group_of) {
    group = static_cast<int>(labels.size());
    labels.push_back(label);
  }
  std::vector<GroupedSegment> grouped;
  grouped.reserve(segments.size());
  for (const auto& segment : segments) {
    grouped.push_back({segment.px, group_of.at(segment.label), 1.0, segment.strength});
  }
  std::vector<ImageSegment> merged;
  for (const auto& segment :
       mergeCollinear(std::move(grouped), {params.angle_rad, params.offset_px, params.gap_px})) {
    merged.push_back({segment.px, labels[segment.group], segment.value});
  }
  return merged;
}

}  // namespace vismem
