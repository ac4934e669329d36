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

/// One direction of the camera, and why to look there.
struct GazeAdvice {
  /// Of the camera's axis on the robot: pan > 0 left, tilt > 0 up.
  PanTilt direction;
  /// A point on the axis in odom, where it meets the floor or at most `aim_m` away [m]: what avm::Gaze is
  /// asked for, independent of how the camera is mounted on its unit.
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();
  /// What is told on the way there and there, within the horizon: metres of line times tenths of a second.
  double score = 0.0;
  double telling_m = 0.0;  ///< length of line there that the races expect differently, or none would show
  double novelty = 0.0;    ///< share of the view there that was not seen since doubt began, 0..1
};

/// Pan and tilt of a camera's axis on the robot, however it is mounted.
PanTilt axisOf(const Pose3& T_robot_camera);
/// The angle between two directions [rad].
double angleBetweenAxes(const PanTilt& a, const PanTilt& b);

/// Rates directions of gaze. What it keeps between calls is for how long each bearing was in view.
/// *Single-threaded* (owner: the component's loop).
class GazeAdvisor {
 public:
  /// @param localizer of the Localizer whose races are compared: its fields' cell, gate and opaque labels.
  GazeAdvisor(const GazeAdvisorParams& params, const LocalizerParams& localizer, const SegmentMap& map_edges);

  /// What was seen so far tells nothing more: the robot may be anywhere.
  void forget();
  /// Notes what the camera saw. Every update, also those without advice.
  void look(const MemoryUpdate& update);
  /// The camera does not get to a direction: what lies there counts as seen for a long time.
  void giveUp(const PanTilt& direction, const MemoryUpdate& update);

  /// All candidates, best first. @param estimate of the update; both as Localizer::step takes and gives them.
  /// The camera's place and intrinsics are those of the update's image.
  std::vector<GazeAdvice> advise(const PoseEstimate& estimate, const MemoryUpdate& update) const;

  const GazeAdvisorParams& params() const { return params_; }

 private:
  static constexpr int kBearings = 72;  // in odom: 5 degrees each
  using Bearings = std::array<double, kBearings>;

  /// A visible line's piece, and what seeing it would tell.
  struct Target {
    Eigen::Vector2d p_robot;
    double telling_m = 0.0;
  };
  std::vector<Target> targets(const PoseEstimate& estimate) const;
  /// By bearing, what a camera at this tilt would be told there.
  Bearings tellingAt(double tilt_rad, const std::vector<Target>& targets, const MemoryUpdate& update) const;
  /// What is told until the horizon by a camera that turns from one pan of the robot to another.
  double onTheWay(double from_rad, double to_rad, double heading_rad, double half_width_rad,
                  const Bearings& telling) const;

  GazeAdvisorParams params_;
  MapIndex map_;
  VisibleMap visible_;
  Bearings seen_s_{};  ///< for how long each was in view, of which what is long ago counts less
  std::optional<StampUs> last_look_us_;
  std::optional<double> last_pan_rad_;  ///< of the camera's axis
  double pan_speed_radps_ = 0.0;        ///< as the last two images tell
};

}  // namespace vismem
