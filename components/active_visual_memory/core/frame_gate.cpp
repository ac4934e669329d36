#include "active_visual_memory/core/frame_gate.h"

namespace vismem {

bool FrameGate::opens(const RobotObservation& observation) const {
  if (!params_.enabled || !last_ || last_->epoch != observation.epoch) return true;
  const StampUs passed = observation.frame.stamp_us - last_->stamp_us;
  if (passed < 0 || passed >= toStampUs(params_.max_interval_s)) return true;
  if ((observation.T_odom_robot.position() - last_->T_odom_robot.position()).norm() > params_.distance_m) {
    return true;
  }
  const Pose3 T_odom_camera = toPose3(observation.T_odom_robot) * observation.T_robot_camera;
  const Eigen::AngleAxisd turn(
      Eigen::Matrix3d(last_->T_odom_camera.linear().transpose() * T_odom_camera.linear()));
  return std::abs(turn.angle()) > params_.angle_rad;
}

void FrameGate::passed(const RobotObservation& observation) {
  last_ = Last{observation.frame.stamp_us, observation.epoch,
               toPose3(observation.T_odom_robot) * observation.T_robot_camera, observation.T_odom_robot};
}

}  // namespace vismem
