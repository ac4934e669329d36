/// @file Notices a map whose labels are not those of the visual memory. See C3.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Compares the labels of remembered segments with those of the map. *Single-threaded.*
class LabelWatch {
 public:
  /// Remembered segments with a label that make the comparison meaningful, and how long they must stay [us].
  static constexpr std::size_t kEnoughSegments = 5;
  static constexpr StampUs kPatience_us = 10 * kSecondUs;

  explicit LabelWatch(const SegmentMap& map_edges);

  /// @return empty, or why this memory cannot be localized: for kPatience_us all labels were foreign to the
  /// map. Once one label was on the map, a memory without such labels is a place that the map lacks, and no
  /// reason.
  std::string update(const MemorySnapshot& memory);

 private:
  std::set<Label> labels_;
  bool is_known_ = false;  ///< a label of the memory is one of the map
  std::optional<StampUs> foreign_since_us_;
};

}  // namespace vismem
