/// @file Next best view: the direction of gaze from which the races predict different lines. Pure.
/// Implements B4. Active search: Davison (2005); active localization: Fox, Burgard and Thrun (1998).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/camera.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/likelihood/robust_likelihood.h"
#include "localization/core/map/map_index.h"
#include "localization/core/map/visibility.h"
#include "localization/core/pose_estimate.h"

namespace vismem {

/// Directions and their rating.
struct GazeAdvisorParams {
  double minimum_pan_rad = degToRad(-159.0);  ///< of the camera's axis
  double maximum_pan_rad = degToRad(159.0);
  double minimum_tilt_rad = degToRad(-20.0);
  double maximum_tilt_rad = degToRad(-10.0);  ///< informative lines lie on the floor
  double patience_s = 0.8;                    ///< time constant of the discount of later views
  double half_novelty_s = 0.6;                ///< time in view that halves the novelty of a bearing
  double head_speed_radps = degToRad(150.0);
};

/// One direction of the camera with its rating.
struct GazeAdvice {
  /// Of the camera's axis on the robot: pan > 0 left, tilt > 0 up.
  PanTilt direction;
  /// Gaze point in odom [m]: where the axis meets the floor, at most `aim_m` away. avm::Gaze takes it; it
  /// does not depend on the camera's mount.
  Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();
  /// Information of the views on the way there and there, within the horizon: metres of line times 0.1 s.
  double score = 0.0;
  /// Length of the lines in view there, each weighted by how differently the races predict it [m].
  double informative_m = 0.0;
  double novelty = 0.0;  ///< share of the view there that was not seen since the pose became uncertain, 0..1
};

/// Pan and tilt of a camera's axis on the robot, for any mount.
PanTilt axisOf(const Pose3& T_robot_camera);
/// The angle between two directions [rad].
double angleBetweenAxes(const PanTilt& a, const PanTilt& b);

/// Rates directions of gaze. Its state is the time in view of each bearing.
/// *Single-threaded* (owner: the component's loop).
class GazeAdvisor {
 public:
  /// @param likelihood and @param map of the Localizer whose races are compared.
  GazeAdvisor(const GazeAdvisorParams& params, const LikelihoodParams& likelihood, const MapParams& map,
              const SegmentMap& map_edges);

  /// Sets the time in view of all bearings to 0.
  void reset();
  /// Adds an image's view. To be called for every update.
  void addView(const MemoryUpdate& update);
  /// Marks the bearings of a direction that the camera does not reach as long in view.
  void abandon(const PanTilt& direction, const MemoryUpdate& update);

  /// All candidates, best first. The camera's position and intrinsics are those of the update's image.
  /// @param estimate of the update, as Localizer::update returns it.
  std::vector<GazeAdvice> advise(const PoseEstimate& estimate, const MemoryUpdate& update) const;

 private:
  static constexpr int kBearings = 72;  // in odom: 5 degrees each
  using Bearings = std::array<double, kBearings>;

  /// A piece of an expected line.
  struct Target {
    Eigen::Vector2d p_robot;
    double informative_m = 0.0;
  };
  std::vector<Target> targets(const PoseEstimate& estimate) const;
  /// Informative length by bearing, for a camera at this tilt.
  Bearings informativeAt(double tilt_rad, const std::vector<Target>& targets,
                         const MemoryUpdate& update) const;
  /// Information within the horizon of a camera that turns from one pan of the robot to another.
  double informationOnTheWay(double from_rad, double to_rad, double heading_rad, double half_width_rad,
                             const Bearings& informative_m) const;

  GazeAdvisorParams params_;
  MapIndex map_;
  Visibility visible_;
  Bearings seen_s_{};  ///< decayed time in view
  std::optional<StampUs> last_view_us_;
  std::optional<double> last_pan_rad_;  ///< of the camera's axis
  double pan_speed_radps_ = 0.0;        ///< from the last two images
};

}  // namespace vismem
