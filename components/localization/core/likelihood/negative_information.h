/// @file Negative information: a bounded penalty for poses that predict more lines than the image shows.
/// Pure. See L12. Hoffmann, Spranger, Göhring and Jüngel, "Making use of what you don't see" (2005).
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map/map_index.h"
#include "localization/core/map/visibility.h"
#include "localization/core/observation/floor_observation.h"

namespace vismem {

struct NegativeInformationParams {
  bool enabled = true;
  double detection_probability = 0.7;  ///< of a map segment near the camera and fully in view
};

/// Keeps the set of labels that the camera has ever detected; other labels are not expected.
/// *Single-threaded* (owner: RobustRaces).
class NegativeInformation {
 public:
  /// @param range_m largest range at which a map segment is expected.
  /// @param opaque see Visibility.
  NegativeInformation(const MapIndex& map, const NegativeInformationParams& params, double range_m,
                      std::span<const std::string> opaque)
      : map_(map), params_(params), range_m_(range_m), visible_(map, opaque) {}

  /// Takes the image of an update and its points on the floor.
  void observe(const ImageAnalysis& analysis, const FloorObservation& observation);

  /// Sum of log(1 - p_det) over the map segments that are mostly expected in the image and not observed; each
  /// term is at least log 0.5 [nats]. p_det grows with the visible length and falls with the range. Parts
  /// behind an opaque map segment or behind an observed segment of unknown label are not expected.
  /// @return 0 without an image.
  double logPenalty(const Pose2& T_world_robot) const;

 private:
  const MapIndex& map_;
  NegativeInformationParams params_;
  double range_m_;
  Visibility visible_;
  std::set<int> known_labels_;
  std::optional<CameraView> view_;
  Eigen::Vector2d camera_ = Eigen::Vector2d::Zero();
  std::vector<FloorPoint> seen_;
  std::vector<Segment2> obstacles_;
  mutable std::vector<VisiblePoint> expected_;  // kept for its memory
};

}  // namespace vismem
