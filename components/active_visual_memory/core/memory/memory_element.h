/// @file A remembered segment with the internal state of the memory. Pure. See M1, M3, M4.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "active_visual_memory/core/ground/floor_evidence.h"
#include "active_visual_memory/core/ground/floor_line.h"
#include "active_visual_memory/core/memory/life.h"
#include "active_visual_memory/core/memory/plane_verification.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Votes of the images for the label of an edge; `unknown` votes too. *Value.*
class LabelVotes {
 public:
  void add(const Label& label, double weight);
  void add(const LabelVotes& others);
  /// The named label with the most votes if it has at least this share of all, else `unknown`.
  Label winner(double least_share) const;

 private:
  /// A line seldom shows more labels: a further one takes the place of the one with the fewest votes.
  static constexpr std::size_t kMost = 8;
  std::array<std::pair<Label, double>, kMost> votes_;
  std::size_t count_ = 0;
};

/// *Value.*
struct MemoryElement {
  // What every image reads of all elements comes first: together it fills few cache lines.
  int sightings = 0;                        ///< images that showed it
  Sighting sighting = Sighting::kObserved;  ///< highest since life was last counted
  MemorySegment value;                      ///< as published; its geometry is a copy of `line`
  FloorLine line;
  PlaneVerification plane;
  double strength = 0.0;       ///< mean contrast [grey levels]
  double pixel_m = 1e9;        ///< floor distance of one pixel across the line, in the best view [m]
  double seen_travel_m = 0.0;  ///< odometer when last fused
  double seen_turn_rad = 0.0;
  std::optional<SideColours> colours;
  LabelVotes votes;  ///< nearer views count more
  /// Votes of images for an end further in.
  struct ShortVotes {
    int count = 0;
    /// Their mean place, in odom: fusion moves the origin of the line's t.
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    double variance_m2 = 0.0;  ///< of the latest vote
  };
  ShortVotes short_a;
  ShortVotes short_b;
  /// Votes of images for a gap at one place of it.
  struct GapVotes {
    int count = 0;
    Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< in odom
    Eigen::Vector2d to = Eigen::Vector2d::Zero();
    Eigen::Vector2d camera = Eigen::Vector2d::Zero();  ///< of the first vote: the floor point below it
    double bearing_spread_rad = 0.0;                   ///< of the directions it was seen from
  };
  std::vector<GapVotes> gaps;  ///< one for each place
};

/// A side of a published shape that consists of several remembered segments: they are to be joined.
struct SideCompletion {
  Segment2 side;                           ///< from corner to corner
  decltype(Primitive::segments) segments;  ///< the pieces on it, sorted
};

/// The element with an id; null if there is none. @param elements  a list in the order of their ids.
template <typename Elements>
auto* findElement(Elements&& elements, std::uint64_t id) {
  const auto idOf = [](const MemoryElement& element) { return element.value.id; };
  const auto found = std::ranges::lower_bound(elements, id, {}, idOf);
  return found != elements.end() && found->value.id == id ? &*found : nullptr;
}

/// The elements as they are remembered: nothing derived, one segment each, where its line lies.
std::vector<MemorySegment> valuesOf(std::span<const MemoryElement> elements);

/// Joins another element that is a piece or a copy of the same edge; the id stays (M2, M9).
void absorb(MemoryElement& element, const MemoryElement& other, const FloorLine::Params& params);

/// Standard deviation of an end up to which parallax confirms an element: clients rely on its place [m].
inline constexpr double kMaxConfirmedSigma_m = 0.12;

/// Whether both published ends are known to kMaxConfirmedSigma_m in the mean of all directions.
bool isLocated(const MemorySegment& published);

/// Updates `value` from the state.
/// @param confirmed  whether it counts as confirmed.
/// @param P_tilt     covariance of the camera tilt [rad^2].
void publish(MemoryElement& element, bool confirmed, const CameraTiltCovariance& P_tilt);

}  // namespace vismem
