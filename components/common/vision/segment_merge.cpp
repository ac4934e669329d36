#include "common/vision/segment_merge.h"

#include <algorithm>
#include <tuple>

namespace vismem {

void SegmentMerger::merge(std::vector<ImageSegment>& segments, const MergeParams& params) {
  labels_.clear();
  for (const ImageSegment& segment : segments) {
    const auto at = std::lower_bound(labels_.begin(), labels_.end(), segment.label);
    if (at == labels_.end() || *at != segment.label) labels_.insert(at, segment.label);
  }
  grouped_.clear();
  for (const ImageSegment& segment : segments) {
    const auto label = std::lower_bound(labels_.begin(), labels_.end(), segment.label);
    grouped_.push_back({segment.px, static_cast<int>(label - labels_.begin()), 1.0, segment.strength});
  }
  // The same order whatever that of the input, so that the same pairs are joined.
  const auto in_order = [](const GroupedSegment& x, const GroupedSegment& y) {
    const auto key = [](const GroupedSegment& segment) {
      const Segment2& px = segment.px;
      return std::make_tuple(px.a.x(), px.a.y(), px.b.x(), px.b.y(), segment.group, segment.value);
    };
    return key(x) < key(y);
  };
  std::sort(grouped_.begin(), grouped_.end(), in_order);
  merger_.merge(grouped_, {params.angle_rad, params.offset_px, params.gap_px});
  std::sort(grouped_.begin(), grouped_.end(), in_order);
  segments.resize(grouped_.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const GroupedSegment& joined = grouped_[i];
    segments[i] = {joined.px, labels_[static_cast<std::size_t>(joined.group)], joined.value};
  }
}

}  // namespace vismem
