/// @file Where to look so as to know where one is: where the races disagree most. Pure. SPEC B4; DESIGN 9.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/geometry/camera.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"
#include "localization/core/pose_estimate.h"
#include "localization/core/visible_map.h"

namespace vismem {

/// One direction of the camera, and why to look there. All parts 0..1.
struct GazeAdvice {
  /// Of the camera's axis on the robot: pan > 0 left, tilt > 0 up.
  PanTilt direction;
  /// A point on the axis in odom, where it meets the floor or at most `aim_m` away [m]: what avm::Gaze is
  /// asked for, independent of how the camera is mounted on its unit.
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();
  double score = 0.0;         ///< weighted sum of the following for the time that the look takes [1/s]
  double disagreement = 0.0;  ///< of the races, and of none of them, about what is there
  double information = 0.0;   ///< about the winner's pose
  double coverage = 0.0;      ///< how long the direction was not looked at
  double staleness = 0.0;     ///< how long what is remembered there was not seen
};

/// Pan and tilt of a camera's axis on the robot, however it is mounted.
PanTilt axisOf(const Pose3& T_robot_camera);

/// Rates directions of gaze. What it keeps between calls is when each bearing was last in view.
/// *Single-threaded* (owner: the component's loop).
class GazeAdvisor {
 public:
  /// @param localizer of the Localizer whose races are compared: its fields' cell, gate and opaque labels.
  GazeAdvisor(const GazeAdvisorParams& params, const LocalizerParams& localizer, const SegmentMap& map_edges);

  /// What was seen so far tells nothing more: the robot may be anywhere.
  void forget() { seen_us_.fill(std::nullopt); }
  /// Notes what the camera saw. Every update, also those without advice.
  void look(const MemoryUpdate& update);

  /// All candidates, best first. @param estimate of the update; both as Localizer::step takes and gives them.
  /// The camera's place and intrinsics are those of the update's image.
  std::vector<GazeAdvice> advise(const PoseEstimate& estimate, const MemoryUpdate& update) const;

  const GazeAdvisorParams& params() const { return params_; }

 private:
  static constexpr int kBearings = 72;  // of the coverage, in odom: 5 degrees each

  struct Target {
    Eigen::Vector2d p_robot;
    double disagreement = 0.0;  // share of belief that would tell races apart here, times length
    double length = 0.0;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // about the winner's pose
  };
  std::vector<Target> targets(const PoseEstimate& estimate, double none) const;
  double coverageOf(double bearing_odom, double half_width_rad, StampUs now_us) const;

  GazeAdvisorParams params_;
  MapIndex map_;
  VisibleMap visible_;
  std::array<std::optional<StampUs>, kBearings> seen_us_;
};

}  // namespace vismem
