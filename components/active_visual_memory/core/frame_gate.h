/// @file Choice of the frames to analyse.
/// Pure. Implements V6.
#pragma once

#include <optional>

#include "common/config/parameter_visitor.h"
#include "common/robot/observation.h"

namespace vismem {

/// *Single-threaded* (owner: the perception loop).
class FrameGate {
 public:
  struct Params {
    bool enabled = false;         ///< false: every frame is analysed
    double distance_m = 0.02;     ///< the robot moved further than this
    double angle_rad = 0.02;      ///< the camera turned further than this
    double max_interval_s = 0.2;  ///< or this much time passed

    void visit(ParameterVisitor& v) {
      v.flag(
          expert("Enabled", "V6: analyse a frame only after motion of 2 cm or 1.1 degrees, or after 0.2 s"),
          enabled);
    }
  };

  explicit FrameGate(const Params& params) : params_(params) {}

  /// Whether this frame is to be analysed: the first of each epoch, and after enough motion or time.
  bool opens(const RobotObservation& observation) const;
  /// Notes that this frame was analysed.
  void passed(const RobotObservation& observation);

 private:
  struct Last {
    StampUs stamp_us;
    std::uint32_t epoch;
    Pose3 T_odom_camera;
    Pose2 T_odom_robot;
  };
  Params params_;
  std::optional<Last> last_;
};

}  // namespace vismem
