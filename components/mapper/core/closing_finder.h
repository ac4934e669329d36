/// @file Closings of a drive: places of its own finished map that races find again. Pure. See B6, L2.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/localizer.h"
#include "mapper/core/landmarks.h"
#include "mapper/core/pose_graph.h"

namespace vismem {

struct ClosingParams {
  LocalizerParams localizer;
  double apart_m = 6.0;         ///< the map holds nothing seen later than this way before the search begins
  double search_m = 10.0;       ///< way of one search with one map
  double every_m = 3.0;         ///< a search begins after each such way
  double least_map_m = 6.0;     ///< length of labelled edges that a search needs
  double lead_nats = 6.0;       ///< of one race over all others ..
  double lead_s = 3.0;          ///< .. for this time
  double explained = 0.7;       ///< least share of the observations that it explains
  double next_m = 0.5;          ///< way to the next closing of the same race
  double least_sigma_m = 0.03;  ///< of a closing: the map itself errs
  double least_sigma_rad = 0.01;
};

/// What a search saw, for people.
struct ClosingEvidence {
  double way_m = 0.0;  ///< where the search began
  double map_m = 0.0;  ///< length of its map
  int closings = 0;
  double best_lead_nats = 0.0;
  double best_explained = 0.0;  ///< of the winner with that lead
  double longest_lead_s = 0.0;  ///< with lead and explained share above their bounds
};

struct FoundClosings {
  std::vector<Closing> closings;
  ClosingEvidence evidence;
};

/// Ways at which searches begin.
std::vector<double> searchBegins(const DriveRecord& record, const ClosingParams& params);

/// Runs localization with explorers over the recorded updates from a way on, against the part of the map that
/// is older than `apart_m` then.
/// @param updates  of the memory, in the order of their stamps.
FoundClosings searchClosings(const DriveRecord& record, const std::vector<MemoryUpdate>& updates,
                             const MapState& state, const ClosingParams& params, std::uint64_t seed,
                             double begin_m);

}  // namespace vismem
