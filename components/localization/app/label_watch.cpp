#include "localization/app/label_watch.h"

#include <algorithm>

namespace vismem {
namespace {

/// Names in a message.
constexpr std::size_t kNames = 4;

std::string listed(const std::set<Label>& labels) {
  std::string text;
  std::size_t count = 0;
  for (const Label& label : labels) {
    if (count++ == kNames) return text + " ...";
    text += (text.empty() ? "" : ", ") + label;
  }
  return text;
}

}  // namespace

LabelWatch::LabelWatch(const SegmentMap& map_edges) {
  for (const MapSegment& segment : map_edges.segments) labels_.insert(segment.label);
  is_known_ = labels_.contains(kAnyLabel);
}

std::string LabelWatch::update(const MemorySnapshot& memory) {
  if (is_known_) return {};
  std::set<Label> foreign;
  std::size_t labelled = 0;
  for (const MemorySegment& segment : memory.segments) {
    if (segment.label == kUnknownLabel) continue;
    is_known_ |= labels_.contains(segment.label);
    foreign.insert(segment.label);
    ++labelled;
  }
  if (is_known_ || labelled < kEnoughSegments) {
    foreign_since_us_.reset();
    return {};
  }
  // Stamps that go back begin anew.
  foreign_since_us_ = std::min(foreign_since_us_.value_or(memory.stamp_us), memory.stamp_us);
  if (memory.stamp_us - *foreign_since_us_ < kPatience_us) return {};
  return "no label of the visual memory (" + listed(foreign) + ") is on the map (" + listed(labels_) +
         "): Localization.Map and ActiveVisualMemory.Palette must be of the same place";
}

}  // namespace vismem
