/// @file Straight edges on the floor as landmarks of a graph. Pure. See B6.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "common/geometry/segment.h"
#include "mapper/core/keyframe.h"

namespace vismem {

/// One end of a landmark along its line.
struct LandmarkEnd {
  double t_m = 0.0;     ///< from the landmark's reference
  bool closed = false;  ///< false: only a bound, the edge may continue
};

/// A line about a reference point in the frame of its anchor, a keyframe near it: lines about the origin of
/// the world end in local minima. Its direction carries the polarity: the brighter side lies on the left.
/// *Value.*
struct LineLandmark {
  /// A sighting of record.keyframes[keyframe].sightings.
  struct Seen {
    int keyframe = 0;
    int sighting = 0;
  };

  /// Of the first of its elements, times 100; pieces of a line that was cut count up from there. The same
  /// record gives the same ids.
  std::uint64_t id = 0;
  std::vector<std::uint64_t> elements;  ///< of the memory
  Label label = kUnknownLabel;
  int anchor = 0;                                       ///< keyframe
  Eigen::Vector2d reference = Eigen::Vector2d::Zero();  ///< in the anchor's frame [m]
  double direction_rad = 0.0;                           ///< in the anchor's frame, where `line` is zero
  std::array<double, 2> line{};                         ///< offset to the left [m] and turn [rad]
  LandmarkEnd a;
  LandmarkEnd b;
  std::vector<Seen> seen;
  Eigen::Matrix2d P_line = Eigen::Matrix2d::Zero();  ///< of `line`, relative to the anchor
  double sigma_a_m = 0.0;                            ///< of a closed end along the line
  double sigma_b_m = 0.0;
  bool dropped = false;  ///< as ElementSummary, of all elements
  /// Of MapState::circles, which it is a regular chord of: the graph estimates the circle, not its line. < 0:
  /// none.
  int circle = -1;
  int sessions = 1;

  bool isChord() const { return circle >= 0; }
  Eigen::Vector2d along() const;
  Eigen::Vector2d pointAt(double t_m) const;  ///< in the anchor's frame
  Segment2 segment() const { return {pointAt(a.t_m), pointAt(b.t_m)}; }
  /// Takes the present line and extent as the nominal ones: `line` becomes zero, the reference its middle.
  void recentre();
};

/// A painted circle about a reference centre in the frame of its anchor. *Value.*
struct CircleLandmark {
  /// What one image saw of it.
  struct Seen {
    LineLandmark::Seen chord;
    bool is_left = false;  ///< the chord runs counter-clockwise: the brighter side is inside
    double px_m = 0.0;     ///< of one pixel on the floor, across
    /// Where the chord cuts the arc, as rays of the camera at depth 1.
    std::array<Eigen::Vector2d, 2> cuts;
  };

  int anchor = 0;                                    ///< keyframe
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< in the anchor's frame, where `shape` is zero [m]
  /// Of the edges whose brighter side lies outside (0) and inside (1), where `shape` is zero.
  std::array<double, 2> radius_m{};
  std::array<double, 4> shape{};                ///< shift of the centre, change of both radii [m]
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();  ///< of `shape`, relative to the anchor
  std::vector<Seen> seen;
};

/// The estimate of a drive.
struct MapState {
  std::vector<Pose2> poses;                  ///< T_world_robot of the keyframes
  std::vector<Eigen::Vector2d> frame_tilts;  ///< of single images about the robot's x and y [rad]
  Eigen::Vector4d camera_tilt = Eigen::Vector4d::Zero();  ///< CameraTilt [rad]
  /// Lasting errors of odometry: of the way per metre, of the turn per radian, and turn per metre [rad/m].
  Eigen::Vector3d odometry = Eigen::Vector3d::Zero();
  std::vector<LineLandmark> landmarks;
  std::vector<CircleLandmark> circles;  ///< that hold the graph; their chords are landmarks
  /// Elements of the memory whose edges a person deleted, split or named otherwise: what it saw of them does
  /// not speak for the map.
  std::set<std::uint64_t> overruled;

  Segment2 worldSegment(const LineLandmark& landmark) const {
    return transform(poses[static_cast<std::size_t>(landmark.anchor)], landmark.segment());
  }
};

struct LandmarkParams {
  int min_sightings = 3;  ///< keyframes
  double min_length_m = 0.04;
  bool confirmed_only = true;  ///< leaves out what was not confirmed to lie on the floor ..
  int min_unconfirmed = 6;     ///< .. or asks for so many keyframes
};

/// The camera of a keyframe in world, with the estimated tilts.
Pose3 cameraOf(const DriveRecord& record, const MapState& state, int keyframe);

/// Way driven until a sighting [m].
inline double wayAt(const DriveRecord& record, const LineLandmark::Seen& seen) {
  return record.keyframes[static_cast<std::size_t>(seen.keyframe)].way_m;
}

/// Dead reckoning of the keyframes from the origin, and a landmark for each element that was seen often
/// enough.
MapState initialState(const DriveRecord& record, const LandmarkParams& params);

}  // namespace vismem
