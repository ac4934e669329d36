/// @file A remembered segment with what only the memory needs to know of it. Pure. SPEC M1, M3, M4.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "active_visual_memory/core/floor_evidence.h"
#include "active_visual_memory/core/floor_line.h"
#include "active_visual_memory/core/life.h"
#include "active_visual_memory/core/parallax.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// What the images called an edge; `unknown` votes too. *Value.*
class LabelVotes {
 public:
  void add(const Label& label, double weight);
  void add(const LabelVotes& others);
  /// The named label with the most votes, if it has at least this share of all; else `unknown`.
  Label winner(double least_share) const;

 private:
  std::vector<std::pair<Label, double>> votes_;
};

/// *Value.*
struct MemoryElement {
  MemorySegment value;  ///< as published; its geometry is a copy of `line`
  FloorLine line;
  double strength = 0.0;  ///< mean contrast [grey levels]
  double pixel_m = 1e9;   ///< that one pixel covers across the line, in the best view
  int sightings = 0;      ///< images that showed it
  std::optional<SideColours> colours;
  LabelVotes votes;  ///< nearer views count more
  ParallaxEstimate parallax;
  bool on_floor = false;      ///< its place rests while the camera moves (M1)
  bool stands = false;        ///< its place moves with the camera: it stands up, or moves by itself
  bool not_vertical = false;  ///< some view ruled out a vertical edge
  FloorLine anchor_line;      ///< where the first sample of `parallax` saw it
  Eigen::Vector2d anchor_camera = Eigen::Vector2d::Zero();
  double anchor_turn_rad = 0.0;
  double seen_travel_m = 0.0;  ///< odometer when last fused
  double seen_turn_rad = 0.0;
  Sighting sighting = Sighting::kObserved;  ///< best since life was last counted
  struct ShortVotes {
    int count = 0;
    double t_m = 0.0;
    double variance_m2 = 0.0;
  };
  ShortVotes short_a;
  ShortVotes short_b;
  /// Where images show two pieces of it with a gap between.
  struct GapVotes {
    int count = 0;
    Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< in odom
    Eigen::Vector2d to = Eigen::Vector2d::Zero();
    Eigen::Vector2d camera = Eigen::Vector2d::Zero();  ///< that saw it first: the floor point below it
    double bearing_spread_rad = 0.0;                   ///< in what directions it was seen, against the first
  };
  std::vector<GapVotes> gaps;  ///< one for each place
};

/// M2, M9: takes in another element that is a piece or a copy of the same edge; the id stays.
void absorb(MemoryElement& element, const MemoryElement& other, const FloorLine::Params& params);

/// Brings `value` up to date. @param confirmed whether it counts as confirmed. @param P_lean of the camera's
/// lean.
void publish(MemoryElement& element, bool confirmed, const LeanCovariance& P_lean);

}  // namespace vismem
