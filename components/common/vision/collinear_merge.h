/// @file Joins collinear segments of one group whose ends are close. Pure. The core of V4, also used by
/// detectors.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct CollinearMergeParams {
  double angle_rad = 0.07;  ///< between the directions over the full circle: polarity counts
  double offset_px = 1.5;   ///< of the shorter one's ends from the longer one's line
  double gap_px = 8.0;      ///< between the near ends along the line; overlapping pieces have none
};

struct GroupedSegment {
  Segment2 px;
  int group = 0;        ///< only segments of one group are joined
  double weight = 1.0;  ///< `value` is averaged with weight times length
  double value = 0.0;
};

/// *Single-threaded*; keeps its work space and no memory of earlier segments.
class CollinearMerger {
 public:
  CollinearMerger();
  ~CollinearMerger();
  CollinearMerger(CollinearMerger&&) noexcept;
  CollinearMerger& operator=(CollinearMerger&&) noexcept;

  /// Takes the work space for so many segments now, so that merging them allocates nothing.
  void reserve(std::size_t segments);

  /// Joins, pass by pass, the pairs with the smallest gaps, each segment at most once in a pass, until no
  /// pair is left. A joined segment lies on the total-least-squares line of its parts (taken as rods of even
  /// density) and reaches as far as they do. Segments without length are dropped.
  /// @param segments replaced by the joined ones; their order depends on the order of the input.
  void merge(std::vector<GroupedSegment>& segments, const CollinearMergeParams& params);

 private:
  struct Rod;
  struct Candidate;
  class Lanes;

  void lay(const CollinearMergeParams& params);
  std::pair<int, int> stripsOf(const Rod& rod, const CollinearMergeParams& params) const;
  void findCandidates(int first_fresh, const CollinearMergeParams& params);
  void compare(int rod, const Lanes& lanes, int begin, int end, const CollinearMergeParams& params);
  void judge(int rod, int other, const CollinearMergeParams& params);

  std::vector<Rod> rods_;
  std::vector<Candidate> candidates_;
  /// The rods given, by strip of the plane and then by direction; those that a strip touches are in it.
  std::unique_ptr<Lanes> given_;
  std::vector<int> strip_begin_;
  /// The joined ones, in no order.
  std::unique_ptr<Lanes> joined_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint8_t> near_;
  double cos_limit_ = 0.0;
  int strip_count_ = 1;
  double low_y_ = 0.0;
  double strip_px_ = 1.0;
  double slack_px_ = 0.0;
};

}  // namespace vismem
