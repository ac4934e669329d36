#include "common/vision/segment_merge.h"

#include <algorithm>
#include <map>
#include <tuple>

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
  // The same order whatever that of the input, so that the same pairs are joined.
  const auto in_order = [](const GroupedSegment& x, const GroupedSegment& y) {
    const auto key = [](const GroupedSegment& segment) {
      const Segment2& px = segment.px;
      return std::make_tuple(px.a.x(), px.a.y(), px.b.x(), px.b.y(), segment.group, segment.value);
    };
    return key(x) < key(y);
  };
  std::sort(grouped.begin(), grouped.end(), in_order);
  CollinearMerger().merge(grouped, {params.angle_rad, params.offset_px, params.gap_px});
  std::sort(grouped.begin(), grouped.end(), in_order);
  std::vector<ImageSegment> merged;
  merged.reserve(grouped.size());
  for (const auto& segment : grouped) merged.push_back({segment.px, labels[segment.group], segment.value});
  return merged;
}

}  // namespace vismem
