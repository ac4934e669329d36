/// @file What changed in a place since its map was made. Pure. See B6.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/segment_map/segment_map.h"

namespace vismem {

/// A row of a map with how often it was seen.
struct CountedRow {
  MapSegment row;
  int times_seen = 0;  ///< keyframes
  int sessions = 0;    ///< drives that saw it; 0: not by a drive
};

struct ChangeParams {
  double near_m = 0.08;     ///< an edge this near is the same one
  double angle_rad = 0.2;   ///< and of this direction
  double range_m = 3.0;     ///< the floor is seen up to here
  int least_views = 3;      ///< of a place on the floor before its emptiness counts
  double gone_share = 0.7;  ///< of what was seen of an edge: it is gone, or it is new
  double least_m = 0.12;    ///< shorter changes are left out
  double thing_m = 0.12;    ///< edges of one label this near belong to one thing
  /// A thing that is no larger is rigid: it is there or not, as a whole. Larger ones are judged by edges.
  double most_thing_m = 1.0;
  double least_moved_m = 0.15;  ///< less is within the errors of two maps
  double most_moved_m = 3.0;
  /// Log likelihood ratio of a place without the edge against one with it, as often seen as before [nats].
  double least_nats = 2.0;
  double least_alone_nats = 6.0;  ///< the same of an edge that is a thing by itself
  double false_sighting = 0.02;   ///< probability of a sighting where there is no edge, by image
  double views_in_one = 2.0;      ///< successive images fail together: so many count as one
  /// Labels of what hides the floor behind it (see matchesAny).
  std::vector<std::string> opaque_labels{"skirting", "*_foot"};
};

/// An image as a view of the floor.
struct SeenView {
  CameraIntrinsics intrinsics;
  Pose3 T_map_camera = Pose3::Identity();
};

/// An edge that the memory held, also one that it never confirmed: what is missing in a map may have been
/// seen nevertheless.
struct FloorTrace {
  Segment2 floor;
  Label label = kUnknownLabel;
  int sightings = 0;  ///< images that showed it
};

/// What a drive saw of the floor.
struct SeenFloor {
  std::vector<SeenView> views;
  std::vector<FloorTrace> traces;
};

SeenFloor transform(const Pose2& T_a_b, SeenFloor seen_b);

/// What all drives before saw.
struct SeenBefore {
  std::vector<SeenFloor> sessions;
  bool is_complete = true;  ///< the map shows all of the place, whatever was seen: a drawing
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

/// Half of a change: a thing that is gone, or one that came.
struct ChangeFact {
  bool is_gone = false;
  Label label;
  std::vector<Segment2> edges;
};

/// The facts of changes: of a moved thing both.
std::vector<ChangeFact> factsOf(const MapChange& change);
/// The same label, and every edge has its counterpart: what a second drive finds again.
bool isSameFact(const ChangeFact& one, const ChangeFact& other);

/// What a drive found against a map.
struct MapComparison {
  std::vector<MapChange> changes;
  /// Edges of now where no drive before saw the floor: neither new nor as before.
  std::vector<MapSegment> added;
  std::vector<ChangeFact> rejected;  ///< before, and this drive does not speak against them
};

/// Compares edges on the floor, point by point: an old edge is gone where views show its place, unhidden by
/// the edges of now, and no edge of now lies there; an edge of now is new where the old views showed the
/// place and no old edge lies there. An edge that few of the images showed that looked at it must be missing
/// in many more before it is gone. What one of both drives did not see is unchanged. What was rejected and is
/// still so is no change.
/// @param before, now           with stripes expanded, in one frame.
/// @param seen_before, seen_now by both sides' drives.
MapComparison compareMaps(const std::vector<CountedRow>& before, const SeenBefore& seen_before,
                          const std::vector<CountedRow>& now, const SeenFloor& seen_now,
                          const ChangeParams& params = {}, const std::vector<ChangeFact>& rejected = {});

}  // namespace vismem
