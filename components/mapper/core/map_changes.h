/// @file What changed in a place since its map was made. Pure. See B6.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "localization/core/map/visibility.h"

namespace vismem {

struct ChangeParams {
  double near_m = 0.08;     ///< an edge this near is the same one
  double angle_rad = 0.2;   ///< and of this direction
  double range_m = 3.0;     ///< the floor is seen up to here
  int least_views = 5;      ///< of a place on the floor before its emptiness counts
  double gone_share = 0.7;  ///< of what was seen of an edge: it is gone, or it is new
  double least_m = 0.12;    ///< shorter changes are left out
  double thing_m = 0.15;    ///< edges of one label this near belong to one thing
  double most_moved_m = 3.0;
  /// Labels of what hides the floor behind it (see matchesAny).
  std::vector<std::string> opaque_labels{"skirting", "*_foot"};
};

/// An image as a view of the floor.
struct FloorView {
  Eigen::Vector2d camera;  ///< below it [m]
  CameraView view;
};

/// What a drive saw of the floor.
struct SeenFloor {
  std::vector<FloorView> views;
  /// All that the memory ever held on the floor, also what it never confirmed: an edge that is missing in a
  /// map may have been seen nevertheless.
  std::vector<Segment2> traces;
};

/// A thing (edges of one label that hang together) that was moved or removed, or is new.
struct MapChange {
  enum class Kind { kMoved, kRemoved, kNew };
  Kind kind = Kind::kMoved;
  Label label;
  std::vector<Segment2> before;  ///< in the frame of the old map [m]; empty for kNew
  std::vector<Segment2> now;     ///< in the same frame; empty for kRemoved
};

/// "moved", "removed", "new".
std::string nameOf(MapChange::Kind kind);
/// Mean of the edges' middles, by length.
Eigen::Vector2d placeOf(const std::vector<Segment2>& edges);

/// Compares edges on the floor, point by point: an old edge is gone where views show its place, unhidden by
/// the edges of now, and no edge of now lies there; an edge of now is new where the old views showed the
/// place and no old edge lies there. What one of both drives did not see is unchanged.
/// @param before, now           with stripes expanded, in one frame.
/// @param seen_before, seen_now by both drives. Without old views everything was seen then.
std::vector<MapChange> mapChanges(const SegmentMap& before, const SeenFloor& seen_before,
                                  const SegmentMap& now, const SeenFloor& seen_now,
                                  const ChangeParams& params = {});

}  // namespace vismem
