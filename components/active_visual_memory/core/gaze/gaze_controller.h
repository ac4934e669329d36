/// @file Gaze control: state machine, controllers, modes of clients.
/// Pure. Implements A4, A5, A6. See A1.
#pragma once

#include <optional>
#include <vector>

#include "active_visual_memory/core/gaze/attention.h"
#include "active_visual_memory/core/gaze/gaze_motion.h"
#include "common/config/parameter_visitor.h"
#include "common/geometry/angles.h"
#include "common/robot/observation.h"
#include "common/robot/rig.h"
#include "common/visual_memory/gaze.h"

namespace vismem {

/// Conditions of the state machine (A5).
struct GazeConditions {
  bool has_target = false;   ///< state 0 found a point
  bool target_gone = false;  ///< the point vanished (forgotten, withdrawn, past its deadline)
  bool arrived = false;      ///< the axis is on the target and the head is quiet
  bool timed_out = false;    ///< the target was not reached in time (A6)
  bool relevant = false;     ///< the image shows what the target stands for
  bool analysed = false;     ///< state 2 lasted long enough
  bool tracked = false;      ///< state 3 lasted long enough
};

/// The transition function of A5. *Pure.*
GazeState nextGazeState(GazeState state, const GazeConditions& conditions);

/// One proportional controller of A4. @return speed, 0 inside the dead zone,
/// never above `maximum`.
double proportionalSpeed(double error, double dead_zone, double gain, double maximum);

/// *Single-threaded* (owner: the perception loop). Invariant: commanded angles
/// lie inside the limits.
class GazeController {
 public:
  /// kProportional: rates, as in the chapter. kPosition: minimum-jerk saccades, and tracking with
  /// feed-forward of the motions of robot and target; the unit is given positions and rates.
  enum class Control { kProportional, kPosition };

  struct Params {
    GazeMode initial_mode = GazeMode::kAttend;
    Control control = Control::kPosition;
    /// Tilts at which remembered elements are looked at: the floor fills the image.
    double object_min_tilt_rad = -0.541;
    double object_max_tilt_rad = -0.14;
    double quiet_radps = 0.35;  ///< the axis rests on the target when it moves
                                ///< slower than this against it
    double analyse_s = 0.25;
    double track_s = 0.5;
    double client_track_s = 1.0;
    /// Limits of the unit that kPosition keeps: 150 degrees/s and 1000 degrees/s^2.
    AxisLimits pan{2.618, 17.45};
    AxisLimits tilt{2.618, 17.45};
    double lookahead_s = 0.01;  ///< from an image's stamp until a command acts

    void visit(ParameterVisitor& v);
    /// @param rig whose whole tilt range the chapter uses for objects, too.
    static Params chapter(const Rig& rig);
  };

  GazeController(const Params& params, const Rig& rig);

  /// One iteration.
  /// @param memory_segments  of this image: whether the target is visible (A5).
  /// @return the next command; empty if there is nothing new, or no pan-tilt unit.
  std::optional<PanTiltCommand> update(const RobotObservation& observation,
                                       std::span<const MemorySegment> memory_segments, AttentionPool& pool);

  /// Between two images, after new requests: turns to an urgent request, or follows a jump of the visited
  /// request, before the next image. A visit of another client goes on; nothing happens while images are
  /// lost.
  /// @return the next command; empty if there is nothing new.
  std::optional<PanTiltCommand> preempt(AttentionPool& pool);

  /// Images are lost: holds the head until they return.
  std::optional<PanTiltCommand> imagesLost();

  void setMode(GazeMode mode);
  void fixate(const Eigen::Vector3d& p_odom);
  /// Drops the target: the frame of its place is not valid any more.
  void abandonTarget();

  std::optional<std::uint64_t> attended() const;
  /// @param status replaced.
  void report(StampUs stamp_us, const AttentionPool& pool, GazeStatus& status) const;

 private:
  struct Aim {
    PanTilt wanted;   ///< where the target is
    PanTilt clamped;  ///< the nearest the unit can do
    bool reachable = true;
  };
  Aim aimAt(const AttentionPoint& point, const Pose2& T_odom_robot) const;
  /// Predicted angles to a point some time after the observation, with the motions of robot and point.
  PanTilt predictAim(const AttentionPoint& point, const RobotObservation& observation, double ahead_s) const;
  std::optional<PanTiltCommand> command(const AttentionPoint& point, const RobotObservation& observation);
  /// Holds the angles, commanded once.
  std::optional<PanTiltCommand> hold();
  /// Advances the state machine for the present target.
  void review(const RobotObservation& observation, std::span<const MemorySegment> memory_segments,
              AttentionPool& pool);
  /// Updates place and motion of the target, the error of the axes and its rate.
  Aim updateTarget(const RobotObservation& observation);
  std::optional<PanTiltCommand> attend(const RobotObservation& observation,
                                       std::span<const MemorySegment> segments, AttentionPool& pool);
  void enter(GazeState state, StampUs stamp_us);
  void select(const RobotObservation& observation, AttentionPool& pool);

  Params params_;
  Rig rig_;
  GazeMode mode_;
  GazeState state_ = GazeState::kSelect;
  std::optional<AttentionPoint> target_;
  std::optional<Eigen::Vector3d> fixation_;
  StampUs entered_us_ = 0;
  std::uint64_t visits_ = 0;
  std::uint64_t given_up_ = 0;
  std::optional<PanTilt> last_angles_;
  StampUs last_stamp_us_ = 0;
  Pose2 last_pose_;
  double dt_s_ = 0.0;  ///< since the image before; 0: not known
  TargetMotion motion_;
  std::optional<Saccade> saccade_;
  std::uint64_t saccade_id_ = 0;
  std::uint64_t error_id_ = 0;
  std::optional<PanTilt> error_;
  double error_rate_radps_ = 0.0;
  double robot_v_mps_ = 0.0;
  double robot_w_radps_ = 0.0;
  std::optional<PanTilt> sent_;
  StampUs sent_us_ = 0;
  bool hold_sent_ = false;
  bool blind_ = false;  ///< images are lost
};

}  // namespace vismem
