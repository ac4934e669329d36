/// @file Joins collinear segments of one group whose ends are close. Pure. The core of V4, also used by
/// detectors.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/edge_rows.h"

namespace vismem {

struct CollinearMergeParams {
  double angle_rad = 0.07;  ///< between the directions over the full circle: polarity counts
  double offset_px = 1.5;   ///< of the shorter one's ends from the longer one's line
  double gap_px = 8.0;      ///< between the near ends along the line; overlapping pieces have none
  /// A longer gap is closed where the edge continues in it (see GapEvidence): at most this multiple of the
  /// shorter one's length, and at most this long.
  double bridge_share = 0.0;
  double bridge_px = 0.0;
};

/// Evidence of the image for an edge in the gap between two pieces.
class GapEvidence {
 public:
  virtual ~GapEvidence() = default;
  /// @param gap from the end of `before` to the beginning of `after`; length > 0.
  virtual bool goesOn(const Segment2& gap, const Segment2& before, const Segment2& after) const = 0;
};

struct GroupedSegment {
  Segment2 px;
  int group = 0;        ///< only segments of one group are joined
  double weight = 1.0;  ///< `value` is averaged with weight times length
  double value = 0.0;
};

/// *Single-threaded*; keeps its work space, but no data of earlier segments.
class CollinearMerger {
 public:
  explicit CollinearMerger(const EdgeRowKernel& kernel = bestEdgeRows());
  ~CollinearMerger();
  CollinearMerger(CollinearMerger&&) noexcept;
  CollinearMerger& operator=(CollinearMerger&&) noexcept;

  /// Allocates the work space for a number of segments, so that merging them allocates nothing.
  void reserve(std::size_t segments);

  /// Joins, pass by pass, the pairs with the smallest gaps, each segment at most once in a pass, until no
  /// pair is left. A joined segment lies on the total-least-squares line of its parts (as rods of uniform
  /// density) and reaches as far as they do. Segments without length are dropped.
  /// @param segments replaced by the joined ones; their order depends on the order of the input.
  /// @param evidence closes longer gaps; nullptr: none is closed.
  void merge(std::vector<GroupedSegment>& segments, const CollinearMergeParams& params,
             const GapEvidence* evidence = nullptr);

 private:
  struct Rod;
  struct Candidate;
  struct Box;
  class Lanes;

  void lay(int begin, const CollinearMergeParams& params, Lanes& lanes);
  void findCandidates(int given, int first_fresh, const CollinearMergeParams& params);
  void compare(const Box& box, int begin, const Lanes& lanes, const CollinearMergeParams& params);
  /// Between a rod and a longer one.
  double longestGap(const Rod& shorter, const CollinearMergeParams& params) const;
  void judge(int rod, int other, const CollinearMergeParams& params);
  bool goesOn(const Rod& a, const Rod& b) const;

  const EdgeRowKernel* kernel_;
  std::vector<Rod> rods_;
  std::vector<Candidate> candidates_;
  std::unique_ptr<Lanes> given_;   // the rods given
  std::unique_ptr<Lanes> joined_;  // those joined that are left
  std::vector<Box> boxes_;
  std::vector<std::int32_t> overlapping_;
  const GapEvidence* evidence_ = nullptr;
  double cos_limit_ = 0.0;
  double reach_px_ = 0.0;  // of a rod aside, see Lanes::boxOf
  std::uint16_t angle_limit_ = 0;
};

}  // namespace vismem
