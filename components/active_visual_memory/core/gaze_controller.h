/// @file Where the head turns next: state machine, controllers, clients' modes.
/// Pure. SPEC A1, A4-A6.
#pragma once

#include <optional>
#include <vector>

#include "active_visual_memory/core/attention.h"
#include "active_visual_memory/core/gaze_motion.h"
#include "common/robot/observation.h"
#include "common/visual_memory/gaze.h"

namespace vismem {

/// What the state machine looks at (A5).
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

/// Requests of clients, waiting for the loop. *Single-threaded*: a component
/// guards it where clients live in other threads. Checks its arguments, so that
/// the loop need not.
class GazeMailbox final : public GazeClient {
 public:
  struct Message {
    enum class Kind { kMode, kFixate, kRequest, kWithdraw };
    Kind kind = Kind::kMode;
    GazeMode mode = GazeMode::kAttend;                 ///< kMode
    Eigen::Vector3d p_odom = Eigen::Vector3d::Zero();  ///< kFixate
    GazeRequest request;                               ///< kRequest; of kWithdraw only client and key
  };

  /// kFixate goes back to the last fixated place; rejected when there was none.
  PortReply setMode(GazeMode mode) override;
  PortReply fixate(const Eigen::Vector3d& p_odom) override;
  PortReply request(const GazeRequest& request) override;
  PortReply withdraw(const std::string& client, const std::string& key) override;
  std::optional<GazeStatus> status() override { return status_; }

  /// A message that another mailbox has checked and taken.
  void post(const Message& message) { messages_.push_back(message); }
  /// For the owner: what came since the last call, oldest first.
  std::vector<Message> take();
  void publish(GazeStatus status) { status_ = std::move(status); }

 private:
  bool has_fixation_ = false;
  std::vector<Message> messages_;
  std::optional<GazeStatus> status_;
};

/// *Single-threaded* (owner: the perception loop). Invariant: commanded angles
/// lie inside the limits.
class GazeController {
 public:
  /// kProportional: speeds, as the chapter has it. kPosition: saccades of least
  /// jerk and tracking led by the motions of robot and target; the unit is
  /// given positions to go to and how fast.
  enum class Control { kProportional, kPosition };

  struct Params {
    GazeMode initial_mode = GazeMode::kAttend;
    Control control = Control::kPosition;
    CameraMount mount;
    double min_pan_rad = -2.775;
    double max_pan_rad = 2.775;
    double min_tilt_rad = -0.541;
    double max_tilt_rad = 0.541;
    /// Remembered things are looked at with tilts in here, so that the floor
    /// fills the image.
    double object_min_tilt_rad = -0.541;
    double object_max_tilt_rad = -0.14;
    double reach_pan_rad = 0.35;  ///< a target this far beyond a limit is still in the image
    double reach_tilt_rad = 0.35;
    double arrived_rad = 0.05;
    double quiet_radps = 0.35;  ///< the axis rests on the target when it moves
                                ///< slower than this against it
    double saccade_timeout_s = 4.0;
    double analyse_s = 0.25;
    double track_s = 0.5;
    double client_track_s = 1.0;
    /// What the unit can do: 150 degrees per second and 1000 per second
    /// squared, which kPosition keeps to.
    double max_pan_rate_radps = 2.618;
    double max_tilt_rate_radps = 2.618;
    double max_pan_acceleration_radps2 = 17.45;
    double max_tilt_acceleration_radps2 = 17.45;
    double saccade_slowdown = 1.25;  ///< least jerk is taken while it needs at
                                     ///< most this multiple of the least time
    double saccade_rad = 0.07;       ///< farther targets are reached by a saccade,
                                     ///< nearer ones by tracking
    double lookahead_s = 0.01;       ///< from an image's stamp until a command acts
    double max_step_s = 0.2;         ///< commands look at most this far ahead of the next image
    double resend_s = 0.5;           ///< an unchanged position command is repeated after this
    double resend_rad = 0.004;
    // A4, kProportional. Degrees in the chapter.
    double pan_dead_zone_rad = 0.3 * 3.14159265358979 / 180.0;
    double tilt_dead_zone_rad = 0.1 * 3.14159265358979 / 180.0;
    double gain_per_s = 3.0;
  };

  explicit GazeController(const Params& params);

  /// One iteration. @param memory_segments of this image's snapshot, for what
  /// is relevant.
  /// @return the command to give now; empty when nothing is to be said or there
  /// is no pan-tilt unit.
  std::optional<PanTiltCommand> step(const RobotObservation& observation,
                                     std::span<const MemorySegment> memory_segments, AttentionPool& pool);

  /// Between two steps, after clients asked: turns to an urgent wish, or to where the wish that is being
  /// looked at has jumped, before the next image comes. A visit that another client has goes on; nobody is
  /// obeyed while the images are gone.
  /// @return the command to give now; empty when nothing is to be said.
  std::optional<PanTiltCommand> redirect(AttentionPool& pool);

  /// The images are gone: stand still until they come back.
  std::optional<PanTiltCommand> imagesLost();

  void setMode(GazeMode mode);
  void fixate(const Eigen::Vector3d& p_odom);
  /// Forgets the target: the frame of its place is no more.
  void abandonTarget();

  std::optional<std::uint64_t> attended() const;
  GazeStatus status(StampUs stamp_us, const AttentionPool& pool) const;

 private:
  struct Aim {
    PanTilt wanted;   ///< where the target is
    PanTilt clamped;  ///< the nearest the unit can do
    bool reachable = true;
  };
  Aim aimAt(const AttentionPoint& point, const Pose2& T_odom_robot) const;
  /// The head's angles to a point some time after the observation, robot and
  /// point moving on as they do.
  PanTilt aimAhead(const AttentionPoint& point, const RobotObservation& observation, double ahead_s) const;
  std::optional<PanTiltCommand> steer(const AttentionPoint& point, const RobotObservation& observation);
  std::optional<PanTiltCommand> steerByRates(const PanTilt& error) const;
  /// Keeps the angles, said once.
  std::optional<PanTiltCommand> hold();
  /// How far the axis is from the aim, and how fast that changes.
  void noteError(std::uint64_t point_id, const PanTilt& error, double dt_s);
  /// Whether the visit of the target goes on.
  void review(const RobotObservation& observation, std::span<const MemorySegment> memory_segments,
              AttentionPool& pool);
  /// Where the target is now, and how that changes.
  Aim noteTarget(const RobotObservation& observation);
  std::optional<PanTiltCommand> attend(const RobotObservation& observation,
                                       std::span<const MemorySegment> segments, AttentionPool& pool);
  void enter(GazeState state, StampUs stamp_us);
  void select(const RobotObservation& observation, AttentionPool& pool);

  Params params_;
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
  bool blind_ = false;  ///< the images are gone
};

}  // namespace vismem
