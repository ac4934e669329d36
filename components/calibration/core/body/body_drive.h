/// @file How a robot moves while it calibrates itself: it looks at a board on the floor from all around it.
/// Pure: state in, commands out. See B5.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/ports.h"
#include "common/robot/rig.h"

namespace vismem {

struct BodyDriveParams {
  Rig rig;               ///< as described; wrong by some degrees and centimetres is fine
  double fence_m = 2.0;  ///< the robot's middle never gets further from the board's middle
  double ring_m = 1.1;   ///< radius of its ways around the board
  double robot_radius_m = 0.25;
  double board_radius_m = 0.25;  ///< half of the board's diagonal: never driven over
  double speed_mps = 0.3;
  double turn_rate_radps = 0.7;
  double look_rate_radps = 1.0;  ///< of the head while it looks
  int rounds = 4;                ///< around the board, each way
  bool drive = true;             ///< false: head only
};

/// @return empty if usable, otherwise the problem for people: the value and the rule.
std::string checkBodyDrive(const BodyDriveParams& params);

struct BodyDriveState {
  StampUs stamp_us = 0;
  PanTilt joints;
  Pose2 T_odom_robot;
};

struct BodyDriveCommand {
  std::optional<PanTiltCommand> head;
  double v_mps = 0.0;
  double w_radps = 0.0;
  bool take_view = false;  ///< the image of about now is worth looking at
};

/// One step of the plan, for people and for progress.
enum class BodyDrivePhase { kSearch, kLooks, kSweeps, kTurns, kRing, kDone, kStopped };

/// The plan: find the board with the head; look at it at rest in a grid of directions; sweep the head over
/// it; turn once each way; drive polygons around it both ways with stops at every second corner.
/// *Single-threaded.* Invariant: commands of the base are zero in kDone and kStopped, and whenever the robot
/// is at the fence or the board has not been seen for kBlind_s: then the head looks for it again.
class BodyDrive {
 public:
  static constexpr double kBlind_s = 6.0;

  /// @param params must be usable (checkBodyDrive).
  explicit BodyDrive(const BodyDriveParams& params);

  /// Where the board's middle lies, from a view of it and the mounting as described; its z says how far the
  /// described camera aims too high or too low.
  void seen(StampUs stamp_us, const Eigen::Vector3d& middle_odom);
  BodyDriveCommand update(const BodyDriveState& state);
  /// Ends the drive, for example at the user's request.
  void stop(const std::string& why);

  BodyDrivePhase phase() const { return phase_; }
  /// Why the drive was stopped; empty unless kStopped.
  const std::string& whyStopped() const { return why_stopped_; }
  std::size_t stepsDone() const { return next_; }
  std::size_t steps() const { return plan_.size(); }

 private:
  struct Step {
    enum class Kind { kLook, kSweep, kTurn, kFace, kGo };
    Kind kind = Kind::kLook;
    BodyDrivePhase phase = BodyDrivePhase::kLooks;
    Eigen::Vector2d offset =
        Eigen::Vector2d::Zero();  ///< kLook: pan, tilt beside the board; kSweep: amplitudes
    double amount = 0.0;          ///< kTurn: angle; kSweep: seconds
    Eigen::Vector2d target = Eigen::Vector2d::Zero();  ///< kFace, kGo: from the board's middle, in odom axes
  };

  void search(const BodyDriveState& state, BodyDriveCommand& command);
  void makePlan(const BodyDriveState& state);
  void addRing(double from_rad, double turn_rad, double radius_m);
  void addSweep(BodyDrivePhase phase, const Eigen::Vector2d& amplitude_rad);
  Step& addStep(Step::Kind kind, BodyDrivePhase phase);
  void addLooks(BodyDrivePhase phase, const std::vector<Eigen::Vector2d>& offsets_rad);
  /// @return whether the step is done.
  bool perform(const Step& step, const BodyDriveState& state, BodyDriveCommand& command);
  bool look(const Step& step, const BodyDriveState& state, BodyDriveCommand& command);
  bool sweep(const Step& step, const BodyDriveState& state, BodyDriveCommand& command);
  bool turn(const Step& step, const BodyDriveState& state, BodyDriveCommand& command);
  bool face(const Step& step, const BodyDriveState& state, BodyDriveCommand& command);
  bool go(const Step& step, const BodyDriveState& state, BodyDriveCommand& command);
  /// Head towards the board, beside it by the offset.
  PanTiltCommand aim(const BodyDriveState& state, const Eigen::Vector2d& offset, double rate_radps) const;
  void viewInMotion(StampUs stamp_us, StampUs interval_us, BodyDriveCommand& command);
  double distanceToBoard(const BodyDriveState& state) const;

  BodyDriveParams params_;
  BodyDrivePhase phase_ = BodyDrivePhase::kSearch;
  std::string why_stopped_;
  std::optional<Eigen::Vector3d> middle_;  ///< in odom; empty: looked for
  std::optional<StampUs> search_us_;       ///< begin of the present search
  StampUs seen_us_ = 0;
  std::vector<Step> plan_;
  std::size_t next_ = 0;
  std::optional<StampUs> begun_us_;    ///< of the present step
  std::optional<StampUs> arrived_us_;  ///< at the present step's aim
  double turned_rad_ = 0.0;            ///< within the present step
  std::optional<double> heading_rad_;  ///< at the update before
  StampUs view_us_ = 0;                ///< of the last view in motion
  bool viewed_ = false;                ///< in the present look
};

}  // namespace vismem
