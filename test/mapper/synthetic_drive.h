/// @file A drive with known truth for tests of the mapper: edges on a floor, a robot on wheels that errs, and
/// what its turning camera shows, with perfect matching while an edge stays known. No code of the mapper is
/// used.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/pose.h"
#include "common/geometry/segment.h"
#include "mapper/core/keyframe.h"

namespace vismem {

struct TrueFloorEdge {
  Segment2 world;  ///< [m], the brighter side on the left
  Label label;
};

struct SyntheticDriveParams {
  std::uint64_t seed = 1;
  double pixel_sigma = 0.4;       ///< of the ends of a segment [px]
  double scale_error = 0.005;     ///< odometry counts this share too much
  double turn_per_rad = 0.01;     ///< and turns this share too much
  double turn_per_m = 0.01;       ///< [rad/m]
  double turn_noise_rad = 0.004;  ///< per keyframe
  double mount_pitch_rad = 0.0;   ///< true tilt of the camera that the kinematics do not know
  double forget_m = 5.0;          ///< an edge unseen for this way gets a new id
  double range_m = 4.0;
  bool blind = false;  ///< no edges are seen: odometry alone
};

struct SyntheticDrive {
  DriveRecord record;
  std::vector<Pose2> truth;  ///< of the keyframes, in world
};

/// Walls of two nested rectangles cut by doors: a ring of corridors around the origin, 9 x 6 m along its
/// middle.
std::vector<TrueFloorEdge> ringOfCorridors();
/// Two parallel walls of 20 m with doors: nothing lies across.
std::vector<TrueFloorEdge> straightCorridor();
/// Two wings at 45 degrees to each other.
std::vector<TrueFloorEdge> slantedWing();

/// Two corridors at right angles, and a shorter wing at 45 degrees behind them.
std::vector<TrueFloorEdge> cornerWithSlantedWing();
/// 20 m along its middle: through both corridors and into the wing.
std::vector<Pose2> wayIntoSlantedWing();

/// A floor of three blocks with corridors around them, 36 x 12 m along their middles; all wings alike.
std::vector<TrueFloorEdge> threeBlocks();
/// 245 m through it: around each block, then around all.
std::vector<Pose2> threeLoops();

/// Poses each 0.25 m along way-points, turning on the spot at corners in steps of 15 degrees.
std::vector<Pose2> wayThrough(const std::vector<Eigen::Vector2d>& points, double length_m);
/// The way along the middle of ringOfCorridors().
std::vector<Pose2> ringWay(double length_m);

/// An image without sightings, by a camera 0.5 m above its robot that looks 25 degrees down.
Keyframe lookDown();

SyntheticDrive drive(const std::vector<TrueFloorEdge>& edges, const std::vector<Pose2>& way,
                     const SyntheticDriveParams& params);

}  // namespace vismem
