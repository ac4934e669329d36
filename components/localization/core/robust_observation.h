/// @file What memory and image say about the place, as weighted points on the floor. Pure. SPEC L12; DESIGN 9
/// part 2.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"

namespace vismem {

/// A point on a remembered segment, in the robot's frame at the observation's stamp.
struct EvidencePoint {
  Eigen::Vector2d p_robot = Eigen::Vector2d::Zero();  ///< [m]
  double direction_robot = 0.0;                       ///< of its segment [rad]
  int label = 0;
  double sigma_m = 0.0;  ///< across the segment
  double weight = 0.0;   ///< independent points it stands for
  double news = 1.0;     ///< share of it that was not told by images before (ObservationNews)
  /// How a lean of the camera moves the point [m/rad] (see Race::camera_lean); zero for remembered points.
  Eigen::Matrix2d d_lean = Eigen::Matrix2d::Zero();
};

/// A remembered segment that can be matched with segments of the map.
struct EvidenceSegment {
  Segment2 robot;
  int label = 0;
  double weight = 0.0;
};

struct RobustObservation {
  std::vector<EvidencePoint> points;      ///< those of the memory first
  std::size_t remembered = 0;             ///< how many they are
  std::vector<EvidenceSegment> segments;  ///< of the memory and of the image
  /// Corners of remembered parallelograms in the robot's frame, counter-clockwise.
  std::vector<std::array<Eigen::Vector2d, 4>> parallelograms;
  double segment_weight = 0.0;  ///< sum over the segments
  double amount = 0.0;          ///< sum of the points' weights before the cap of `effective_points`
  double news = 1.0;            ///< mean of the points', by weight
  double memory_pull = 1.0;     ///< share of the remembered points' pull that moves a place
};

/// What the memory says, as weighted points (see RobustParams). Labels that the map does not have are left
/// out; segments without extent in plan view too.
RobustObservation observeMemory(const MemorySnapshot& snapshot, const MapIndex& map,
                                const RobustParams& params);

/// What one image says: points on its labelled segments that fall on the floor within `image_range_m`.
RobustObservation observeImage(const ImageAnalysis& analysis, const MapIndex& map,
                               const RobustParams& params);

/// Memory, image or both, as `source` says; both must be of one stamp.
RobustObservation observe(const MemoryUpdate& update, const MapIndex& map, const RobustParams& params);

/// Every n-th point, so that few more than `points` remain, with the weight of all.
RobustObservation thinned(const RobustObservation& observation, std::size_t points);

/// Sum over the points.
double weightOf(const RobustObservation& observation);

}  // namespace vismem
