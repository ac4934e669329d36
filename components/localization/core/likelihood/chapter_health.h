/// @file The chapter's two health functions. Pure. Implements L4, L5.
#pragma once

#include <vector>

#include "common/config/parameter_visitor.h"
#include "common/geometry/camera.h"
#include "common/geometry/projection.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"
#include "localization/core/observation/sampling_grid.h"

namespace vismem {

/// Chapter mode.
struct HealthParams {
  /// L4 is the default: its points are what the camera sees now. L5 needs a memory without false elements,
  /// because one off-floor edge costs as much as a wrong pose.
  ObservationSource source = ObservationSource::kImage;
  double memory_scale_m = 0.5;   ///< M of L5
  double image_scale_px = 50.0;  ///< M of L4 at 320 columns; scaled with the image's width
  double memory_range_m = 4.0;   ///< largest range of remembered segments (M5)
  double grid_top_px = 10.0;     ///< height of the sampling grid's cells at the top of a 240-row image
  double grid_bottom_px = 40.0;  ///< the same at its bottom

  void visit(ParameterVisitor& v) {
    v.choice(expert("Source", "chapter: health by the image (L4), the memory (L5), or the mean of both"),
             source,
             {{"memory", ObservationSource::kMemory},
              {"image", ObservationSource::kImage},
              {"both", ObservationSource::kBoth}});
  }
};

/// How the map must be indexed for this health.
MapIndex::Params chapterIndex(const MapParams& map);

/// L4: `H = 1 - mean(d_i) / M`, clamped to 0..1. d_i is the distance in the image to the nearest map line of
/// the label of which any part is in view. Lines are clipped at the near plane, not at the image border. A
/// label without a line in view counts M, which makes the health of one point 0. The image's diagonal is
/// eight times as long: one false label in eight would cost all health, and races would turn until some line
/// of it came into view. Exhaustive over the label's lines.
/// @param points must not be empty; points of one label should be adjacent, for speed.
/// @param scale_px M for this image.
/// @param buffer of the lines in view, kept between calls.
double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px,
                   std::vector<Segment2>& buffer);

/// A remembered segment in the robot's frame (L5).
struct RememberedLine {
  Segment2 robot;  ///< plan view [m]
  int label = 0;
};

/// L5: `H = 1 - mean((d_js + d_je) / 2) / M`, clamped to 0..1, distances in plan view (the memory lies on
/// the floor).
/// @param lines must not be empty.
/// @param scale_m M.
double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m);

/// One observation prepared for rating poses: the memory's lines, the image's points, or both. Segments
/// labelled unknown or with a label that the map lacks are left out. *Single-threaded* (owner: ChapterRaces).
class HealthObservation {
 public:
  HealthObservation(const MapIndex& map, const HealthParams& params) : map_(map), params_(params) {}

  void set(const MemoryUpdate& update);
  /// True: no lines and no points; healths stay unchanged (L4).
  bool isEmpty() const { return lines_.empty() && points_.empty(); }
  /// Number of lines and points, the amount of evidence of the reliability rule.
  std::size_t size() const { return lines_.size() + points_.size(); }
  /// The mean of the health functions that have lines or points.
  double health(const Pose2& T_world_robot) const;

 private:
  double imageScale() const;  // M of L4 for this image

  const MapIndex& map_;
  HealthParams params_;
  std::vector<RememberedLine> lines_;
  std::vector<ImagePoint> points_;  ///< by label
  mutable std::vector<Segment2> in_view_;
  CameraIntrinsics intrinsics_;
  Pose3 T_robot_camera_ = Pose3::Identity();
};

}  // namespace vismem
