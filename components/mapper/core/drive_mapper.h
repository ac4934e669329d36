/// @file From the record of a drive to a map of edges: the order of the solves. Pure. Implements B6.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "active_visual_memory/core/attentive_visual_memory.h"
#include "mapper/core/closing_finder.h"
#include "mapper/core/heading_alignment.h"
#include "mapper/core/landmark_circles.h"
#include "mapper/core/landmark_corners.h"
#include "mapper/core/landmark_ends.h"
#include "mapper/core/landmark_merge.h"
#include "mapper/core/map_edits.h"
#include "mapper/core/map_graph.h"

namespace vismem {

struct DriveMapperParams {
  LandmarkParams landmarks;
  HeadingParams heading;
  GraphParams graph;
  LandmarkMergeParams merge;
  LandmarkEndParams ends;
  OverlapParams overlap;
  EdgesTwiceParams twice;
  CornerJoinParams corners;
  CircleJoinParams circles;
  ClosingParams closing;
  ConsistencyParams consistency;
  double kernel = 2.0;         ///< Cauchy on lines and ends once the graph is near its solution [sigma]
  double most_error_px = 3.0;  ///< landmarks whose median error is larger are not edges on the floor
  /// Of a landmark: so many images that fit the floor outweigh that the memory dropped it.
  int sure_sightings = 8;
  double merge_closed_m = 0.10;  ///< distance across of landmarks of two visits after a closing
  bool close = true;
  bool right_angles = true;
  std::vector<MapEdit> edits;
  std::uint64_t seed = 1;  ///< of the races

  static DriveMapperParams of(const AttentiveVisualMemoryParams& memory, const LocalizerParams& localizer);
};

struct DriveMap {
  MapState state;
  Pose2 T_map_world;  ///< mapFrameOf the map before edits: they leave the places of all else as they were
  int merged = 0;
  int dropped = 0;
  int cut = 0;
  int circles = 0;
  int seen_again = 0;             ///< landmarks that a later visit saw again, with a closing or without
  std::vector<Closing> closings;  ///< accepted
  std::vector<Closing> refused;   ///< found, but neither consistent nor confirmed
  std::vector<ClosingEvidence> searches;
  std::optional<EdgesTwice> twice;  ///< places that must not be trusted
  std::string problem;              ///< empty: the solve is usable
  double seconds = 0.0;             ///< of the solver
  std::vector<std::string> notes;
};

/// Called with the way searched for closings so far and all of it [m].
using MappingProgress = std::function<void(double, double)>;

/// @param record   of one continuous drive.
/// @param updates  of the memory during it, for the races; without them no closing is looked for.
DriveMap mapDrive(const DriveRecord& record, const std::vector<MemoryUpdate>& updates,
                  const DriveMapperParams& params, const MappingProgress& progress = {});

/// The same with the closings that an earlier solve accepted: for edits.
DriveMap mapDriveAgain(const DriveRecord& record, const std::vector<Closing>& accepted,
                       const DriveMapperParams& params);

}  // namespace vismem
