/// @file Which remembered elements show edges of things that move, against the truth. Pure. See M1, M4.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// An edge of a thing that moves, its shadow included, is one that the image would not show without that
/// thing.
enum class EdgeOwner { kNone, kStill, kMoving };

/// What the images showed of one element.
struct ElementHistory {
  StampUs first_us = 0, last_us = 0;  ///< observed, and published
  StampUs confirmed_us = 0;           ///< confirmed at last; 0: never
  int still = 0;                      ///< images that showed an edge that rests
  int moving = 0;                     ///< images that showed an edge of a thing that moves

  bool isOfMoving() const { return moving > still; }
};

/// The histories of all published elements. *Single-threaded*.
class MovingEdges {
 public:
  using Owner = std::function<EdgeOwner(const Segment2& px)>;

  /// @param analysis  of the image of memory.stamp_us. @param owner  of an observed segment of that image.
  void add(const MemorySnapshot& memory, const ImageAnalysis& analysis, const Owner& owner);

  const std::map<std::uint64_t, ElementHistory>& histories() const { return histories_; }
  /// Confirmed elements of a memory that show things that move.
  std::vector<MemorySegment> confirmedOf(const MemorySnapshot& memory) const;
  /// The longest time that an element of a thing that moves was confirmed after it was last observed [s].
  double longestAfter_s() const;

 private:
  std::map<std::uint64_t, ElementHistory> histories_;
};

}  // namespace vismem
