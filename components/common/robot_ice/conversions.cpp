#include "common/robot_ice/conversions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

namespace vismem {

avm::Vector2 toIce(const Eigen::Vector2d& v) {
  return {v.x(), v.y()};
}
avm::Vector3 toIce(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
avm::Pose2 toIce(const Pose2& pose) {
  return {pose.x, pose.y, pose.theta};
}

avm::Pose3 toIce(const Pose3& pose) {
  const Eigen::Quaterniond q(pose.rotation());
  return {toIce(Eigen::Vector3d(pose.translation())), q.w(), q.x(), q.y(), q.z()};
}

avm::Intrinsics toIce(const CameraIntrinsics& c) {
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

avm::PanTiltAngles toIce(const PanTilt& angles) {
  return {angles.pan_rad, angles.tilt_rad};
}

avm::SourceState toIce(SourceState state) {
  switch (state) {
    case SourceState::kRunning:
      return avm::SourceState::Running;
    case SourceState::kFinished:
      return avm::SourceState::Finished;
    case SourceState::kWaiting:
      break;
  }
  return avm::SourceState::Waiting;
}

avm::Symmetric3 toIce(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}

Eigen::Vector2d fromIce(const avm::Vector2& v) {
  return {v.x, v.y};
}
Eigen::Vector3d fromIce(const avm::Vector3& v) {
  return {v.x, v.y, v.z};
}
Pose2 fromIce(const avm::Pose2& pose) {
  return {pose.x, pose.y, pose.theta};
}

std::optional<Pose3> fromIce(const avm::Pose3& pose) {
  const Eigen::Quaterniond q(pose.qw, pose.qx, pose.qy, pose.qz);
  const Eigen::Vector3d p = fromIce(pose.position);
  // Written so that a NaN fails too.
  if (!p.allFinite() || !(std::abs(q.norm() - 1.0) < 0.01)) return std::nullopt;
  Pose3 result = Pose3::Identity();
  result.linear() = q.normalized().toRotationMatrix();
  result.translation() = p;
  return result;
}

CameraIntrinsics fromIce(const avm::Intrinsics& c) {
  return {c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

PanTilt fromIce(const avm::PanTiltAngles& angles) {
  return {angles.panRad, angles.tiltRad};
}

SourceState fromIce(avm::SourceState state) {
  switch (state) {
    case avm::SourceState::Running:
      return SourceState::kRunning;
    case avm::SourceState::Finished:
      return SourceState::kFinished;
    case avm::SourceState::Waiting:
      break;
  }
  return SourceState::kWaiting;
}

Eigen::Matrix3d fromIce(const avm::Symmetric3& m) {
  Eigen::Matrix3d result;
  result << m.m00, m.m01, m.m02, m.m01, m.m11, m.m12, m.m02, m.m12, m.m22;
  return result;
}

bool allFinite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

void requireFinite(const char* name, double value) {
  if (std::isfinite(value)) return;
  throw avm::InvalidArgument(std::string(name) + " = " + std::to_string(value) + " (must be finite)");
}

void requireInRange(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream text;
  text << name << " = " << value << " (must be " << low << ".." << high << ")";
  throw avm::InvalidArgument(text.str());
}

avm::CommandReply toIce(const PortReply& reply) {
  if (!reply.ok()) throw avm::Refused(reply.message);
  const bool adjusted = reply.kind == PortReply::Kind::kAdjusted;
  return {adjusted, adjusted ? reply.message : std::string()};
}

}  // namespace vismem
