/// @file Everything of a drive that a map is made of. Pure. See B6.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "common/robot/samples.h"
#include "common/visual_memory/memory_snapshot.h"
#include "mapper/core/keyframe_recorder.h"

namespace vismem {

/// What races see of an update: without shapes, predictions, and segments further away than localization
/// looks. The result of a search is the same.
/// @param range_m  ObservationParams::range_m.
MemoryUpdate searchedPart(const MemoryUpdate& update, double range_m);

/// The elements of a memory of another process, as far as its updates show them: the published segments, and
/// the elements that are published in parts (at junctions, as sides of shapes; parts have other ids), from
/// the first part to the last one. *Single-threaded* (owner: the loop of the drive).
class PublishedElements {
 public:
  /// To be called for each update, in the order of stamps.
  /// @return an element in parts is where it was last published as one, or predicted and matched. It is
  /// confirmed if confirmed parts cover half of that. It is gone when an image shows its place and the memory
  /// does not predict it there, and 10 s after it was seen.
  std::vector<MemorySegment> of(const MemoryUpdate& update);

 private:
  void addMatched(const MemoryUpdate& update);

  std::map<std::uint64_t, MemorySegment> known_;  ///< as last published or matched
  std::uint32_t epoch_ = 0;
};

/// Collects keyframes and, at the rate of localization, the updates for the races. *Single-threaded* (owner:
/// the loop of the drive).
class DriveCollector {
 public:
  /// @param range_m  as of searchedPart().
  DriveCollector(const KeyframeParams& params, double range_m) : recorder_(params), range_m_(range_m) {}

  /// As KeyframeRecorder::add(), with its errors.
  bool add(const Frame& frame, const MemoryUpdate& update, std::span<const MemorySegment> elements);

  const DriveRecord& record() const { return recorder_.record(); }
  const std::vector<MemoryUpdate>& updates() const { return updates_; }
  bool isBroken() const { return recorder_.isBroken(); }
  double way_m() const { return record().keyframes.empty() ? 0.0 : record().keyframes.back().way_m; }

 private:
  KeyframeRecorder recorder_;
  double range_m_;
  std::vector<MemoryUpdate> updates_;
};

}  // namespace vismem
