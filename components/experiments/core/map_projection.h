/// @file How well the map, projected with the estimated pose, covers the lines that the images show. Pure.
///
/// For recordings without a known truth: the image itself is the judge. Both are in ideal pixels.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/pose.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

struct MapProjectionParams {
  /// Floor points further away than this count for nothing: there, a fraction of a degree of the camera's
  /// pitch joins neighbouring lines, and the image says little about the pose [m].
  double max_range_m = 4.0;
  double step_px = 4.0;  ///< between samples on a segment
};

/// One image and the pose that is being judged by it.
struct JudgedImage {
  std::vector<ImageSegment> observed;
  CameraIntrinsics intrinsics;
  Pose3 T_robot_camera = Pose3::Identity();
  std::optional<Pose2> T_world_robot;  ///< empty: no pose was known
};

/// The visible parts of the map within the range [ideal px]. @param edges the map with stripes expanded.
std::vector<Segment2> projectMap(const std::vector<MapSegment>& edges, const CameraIntrinsics& intrinsics,
                                 const Pose3& T_world_camera, double max_range_m);

/// The distances of one image [px].
struct MapProjectionDistance {
  /// Median over points on the detected map lines of the distance to the nearest projected edge. A detected
  /// line is evidence wherever it is, so this is the measure: a wrong pose leaves detected lines uncovered.
  double detected_to_map_px = 0.0;
  /// Median over points on the projected edges of the distance to the nearest detected line. Lines that are
  /// hidden, blurred or not detected raise it although the pose is right: for comparison. The image's
  /// diagonal when the map projects nowhere near.
  double map_to_detected_px = 0.0;
};

/// @return empty when the image shows no detected line of the map within the range: it says nothing then.
/// Without a pose, or when nothing of the map is in view, both distances are the image's diagonal, so that a
/// failure cannot hide.
std::optional<MapProjectionDistance> mapProjectionDistance(const JudgedImage& image,
                                                           const std::vector<MapSegment>& edges,
                                                           const MapProjectionParams& params = {});

struct MapProjectionScore {
  /// Medians over the images that show lines; empty if none does.
  std::optional<double> detected_to_map_px;
  std::optional<double> map_to_detected_px;
  int images = 0;                ///< judged
  int images_without_lines = 0;  ///< left out: no detected line of the map in range
  int images_without_pose = 0;   ///< counted with the image's diagonal
};

MapProjectionScore scoreMapProjection(const std::vector<JudgedImage>& images, const SegmentMap& edges,
                                      const MapProjectionParams& params = {});

/// The pose at an image's stamp from the newest estimate at or before it, carried forward by odometry.
/// @param estimates      in order of their stamps.
/// @param T_odom_robot   at the image's stamp.
/// @param max_age_us     older estimates say nothing.
std::optional<Pose2> carriedPose(const std::vector<PoseEstimate>& estimates, StampUs stamp_us,
                                 const Pose2& T_odom_robot, StampUs max_age_us = kSecondUs);

}  // namespace vismem
