#include "calibration/core/body/body_start.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "calibration/core/body/body_costs.h"
#include "calibration/core/lens/board_pose.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Longest time offset that is looked for, and time that the image of a head needs to be still.
constexpr double kRest_s = 0.3;
/// More than the steps of a reading, less than a motion.
constexpr double kStill_rad = degToRad(0.15);
/// Travel of a wheel within the rest of a robot that stands [m]: rounding.
constexpr double kStanding_m = 1e-6;

bool stands(const WheelPath& wheels, double from_s, double to_s) {
  const WheelTravel travel = wheels.travelled(from_s - kRest_s, to_s + kRest_s);
  return std::max(travel.left, travel.right) < kStanding_m;
}

std::optional<Eigen::Vector3d> poseAtView(const BodyRecord& record, const BoardView& view,
                                          const BodyParameters& start) {
  const auto T_camera_board = boardPoseFrom(record.intrinsics, record.board, view);
  if (!T_camera_board) return std::nullopt;
  const auto after =
      std::lower_bound(record.joints.begin(), record.joints.end(), view.stamp_us,
                       [](const PanTiltSample& sample, StampUs stamp) { return sample.stamp_us < stamp; });
  const PanTiltSample& joints = after == record.joints.end() ? record.joints.back() : *after;
  return robotFromBoard(*T_camera_board, record.place, start, {joints.pan_rad, joints.tilt_rad});
}

Eigen::Vector3d moved(const Eigen::Vector3d& pose, const Eigen::Vector3d& motion) {
  const double c = std::cos(pose.z());
  const double s = std::sin(pose.z());
  return {pose.x() + c * motion.x() - s * motion.y(), pose.y() + s * motion.x() + c * motion.y(),
          pose.z() + motion.z()};
}

}  // namespace

Eigen::Vector3d robotFromBoard(const Pose3& T_camera_board, BoardPlace place,
                               const BodyParameters& parameters, const PanTilt& reported) {
  Pose3 T_world_board = Pose3::Identity();
  if (place == BoardPlace::kWall) T_world_board.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Pose2 pose =
      toPose2(T_world_board * (cameraPose(parameters, reported) * T_camera_board).inverse(Eigen::Isometry));
  return {pose.x, pose.y, pose.theta};
}

Eigen::Vector3d middleFromRobot(const Pose3& T_robot_camera, const Pose3& T_camera_board,
                                const BoardSpec& board, BoardPlace place) {
  const Eigen::Vector3d middle = middlePosition(board);
  // From the camera to the middle in the board's frame, where its own axis points up.
  Eigen::Vector3d way = middle - T_camera_board.inverse(Eigen::Isometry).translation();
  way[place == BoardPlace::kFloor ? 2 : 1] = 0.0;
  const Eigen::Vector3d camera = T_robot_camera.translation();
  const Eigen::Vector3d ray = T_robot_camera * (T_camera_board * middle) - camera;
  return camera + ray * (way.norm() / std::max(ray.head<2>().norm(), 1e-6));
}

std::vector<bool> stillViews(const BodyRecord& record, const JointPath& joints, const WheelPath& wheels) {
  std::vector<bool> still;
  for (const BoardView& view : record.views) {
    const double t = toSeconds(view.stamp_us);
    still.push_back(joints.spread(t - kRest_s, t + kRest_s) < kStill_rad && stands(wheels, t, t));
  }
  return still;
}

BodyPoses startPoses(const BodyRecord& record, const WheelPath& wheels, const std::vector<bool>& still,
                     const BodyParameters& start) {
  BodyPoses poses;
  poses.deviation.assign(record.views.size(), Eigen::Vector2d::Zero());
  std::optional<Eigen::Vector3d> last;  // pose at the view before
  for (std::size_t v = 0; v < record.views.size(); ++v) {
    const double t = toSeconds(record.views[v].stamp_us);
    const double before = v == 0 ? t : toSeconds(record.views[v - 1].stamp_us);
    const bool same_place = v > 0 && stands(wheels, before, t);
    if (last && !same_place) {
      last = moved(*last, wheels.motion<double>(start.wheels[kLeftScale], start.wheels[kRightScale],
                                                start.wheels[kBase], before, t, before, t));
    }
    if (still[v] && !(same_place && last)) {
      if (const auto seen = poseAtView(record, record.views[v], start)) last = seen;
    }
    if (!last) throw std::runtime_error("the first view of the board at rest gives no pose of the camera");
    if (poses.poses.empty() || !same_place) poses.poses.push_back(*last);
    poses.pose_of_view.push_back(poses.poses.size() - 1);
  }
  return poses;
}

}  // namespace vismem
