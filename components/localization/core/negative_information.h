/// @file What should be in the image and is not: a bounded penalty for places that promise more than is seen.
/// Pure. DESIGN 9 part 2.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/robust_observation.h"
#include "localization/core/visible_map.h"

namespace vismem {

/// Remembers which labels this camera ever saw: what it cannot see is not missed.
/// *Single-threaded* (owner: the strategy).
class NegativeInformation {
 public:
  /// @param opaque see VisibleMap.
  NegativeInformation(const MapIndex& map, const RobustParams& params, std::span<const std::string> opaque)
      : map_(map), params_(params), visible_(map, opaque) {}

  /// Takes the image of an update and its points on the floor.
  void observe(const ImageAnalysis& analysis, const RobustObservation& observation);

  /// Sum over the map's segments of which most should be in the image, and is not, of log(1 - p_det), >= log
  /// 0.5 each; p_det grows with the visible length and falls with the distance. What a wall of the map hides,
  /// or a segment of unknown label in front, is not expected. 0 without an image.
  double logPenalty(const Pose2& T_world_robot) const;

 private:
  const MapIndex& map_;
  const RobustParams& params_;
  VisibleMap visible_;
  std::set<int> known_labels_;
  std::optional<CameraView> view_;
  Eigen::Vector2d camera_ = Eigen::Vector2d::Zero();
  std::vector<EvidencePoint> seen_;
  std::vector<Segment2> obstacles_;
  mutable std::vector<VisiblePoint> expected_;  // kept for its memory
};

}  // namespace vismem
