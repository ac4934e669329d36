/// @file Distance between detected lines and the map projected with the estimated pose, for recordings
/// without a known truth. Both are in ideal pixels. Pure.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

struct MapProjectionParams {
  /// Floor points further away are left out [m]: there, a fraction of a degree of the camera's pitch merges
  /// neighbouring lines, and the image is not informative about the pose.
  double max_range_m = 4.0;
  double step_px = 4.0;  ///< between samples on a segment
};

/// One image and the pose that is compared with it.
struct JudgedImage {
  std::vector<ImageSegment> observed;
  CameraIntrinsics intrinsics;
  Pose3 T_robot_camera = Pose3::Identity();
  std::optional<Pose2> T_world_robot;  ///< empty: no pose was estimated
};

/// The visible parts of the map within the range [ideal px]. @param edges the map with stripes expanded.
std::vector<Segment2> projectMap(const std::vector<MapSegment>& edges, const CameraIntrinsics& intrinsics,
                                 const Pose3& T_world_camera, double max_range_m);

/// The distances of one image [px].
struct MapProjectionDistance {
  /// Median over points on the detected map lines of the distance to the nearest projected edge. This is the
  /// measure: a wrong pose projects no edge onto some detected lines.
  double detected_to_map_px = 0.0;
  /// Median over points on the projected edges of the distance to the nearest detected line, for comparison:
  /// hidden, blurred and undetected lines raise it although the pose is right. The image's diagonal when no
  /// edge is projected.
  double map_to_detected_px = 0.0;
};

/// @return empty when no line of the map was detected within the range. Without a pose, or without a
/// projected edge, both distances are the image's diagonal, so that failures count.
std::optional<MapProjectionDistance> mapProjectionDistance(const JudgedImage& image,
                                                           const std::vector<MapSegment>& edges,
                                                           const MapProjectionParams& params = {});

struct MapProjectionScore {
  /// Medians over the images that show lines; empty if none does.
  std::optional<double> detected_to_map_px;
  std::optional<double> map_to_detected_px;
  int images = 0;                ///< judged
  int images_without_lines = 0;  ///< left out: no line of the map was detected in range
  int images_without_pose = 0;   ///< counted with the image's diagonal
};

MapProjectionScore scoreMapProjection(const std::vector<JudgedImage>& images, const SegmentMap& edges,
                                      const MapProjectionParams& params = {});

/// The pose at an image's stamp, predicted by odometry from the newest estimate at or before it.
/// @param estimates      in order of their stamps.
/// @param T_odom_robot   at the image's stamp.
/// @param max_age_us     older estimates are not used.
/// @return empty without such an estimate.
std::optional<Pose2> carriedPose(const std::vector<PoseEstimate>& estimates, StampUs stamp_us,
                                 const Pose2& T_odom_robot, StampUs max_age_us = kSecondUs);

}  // namespace vismem
