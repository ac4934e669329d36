/// @file The record of a drive for mapping: what selected images showed, and how odometry went on between
/// them. Pure. The elements of the memory are not measurements: their errors are common to all images before.
/// See B6.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "common/robot/samples.h"
#include "common/vision/image_segment.h"

namespace vismem {

/// A remembered segment as one image showed it.
struct LineSighting {
  std::uint64_t element = 0;  ///< of the memory
  /// Ideal pixels, corrected for the detector's blur and shortness; in the direction of the element.
  Segment2 px;
  bool censored_a = false;  ///< the segment was cut here (image border, horizon, range, occluder)
  bool censored_b = false;
};

/// One image with the state of the robot at its stamp.
struct Keyframe {
  StampUs stamp_us = 0;
  Pose2 T_odom_robot;
  Pose3 T_robot_camera = Pose3::Identity();  ///< by the kinematics, without any estimated error
  CameraIntrinsics intrinsics;
  double turn_rate_radps = 0.0;  ///< of the camera
  double way_m = 0.0;            ///< driven since the first keyframe
  double turned_rad = 0.0;       ///< sum of all turns since the first keyframe, >= 0
  std::vector<LineSighting> sightings;
};

/// What the memory knew about one of its elements when a keyframe showed it for the last time.
struct ElementSummary {
  Label label = kUnknownLabel;
  bool confirmed = false;  ///< it lies on the floor
  int first_keyframe = 0;  ///< that showed it
  int last_keyframe = 0;
  Segment2 robot;           ///< in the frame of the robot at `last_keyframe` [m]
  bool censored_a = false;  ///< no image showed the end: it is only a bound
  bool censored_b = false;
  int sightings = 0;  ///< keyframes that showed it
  /// The memory dropped it soon after it was last seen: it was absent, or became a part of another element.
  bool dropped = false;
};

/// Invariant: stamps of keyframes grow; every sighting has a summary.
struct DriveRecord {
  std::vector<Keyframe> keyframes;
  std::map<std::uint64_t, ElementSummary> elements;
};

}  // namespace vismem
