/// @file What robot_log makes of the rows that a bag holds: calibrations, and messages in order of their
/// stamps.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/recording/bag_file.h"
#include "common/robot/samples.h"

namespace vismem {

/// @return nothing for an orientation that is no rotation.
inline std::optional<Pose3> toPose3(const RosPose& recorded) {
  const RosQuaternion& q = recorded.orientation;
  const double norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!std::isfinite(norm) || norm <= 1e-6) return std::nullopt;
  Pose3 pose = Pose3::Identity();
  pose.translation() << recorded.position.x, recorded.position.y, recorded.position.z;
  pose.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  return pose;
}

/// @return empty, or why this is no calibration of a pinhole camera with the distortion of plumb_bob.
inline std::string readCalibration(const RosCameraInfo& info, CameraIntrinsics& intrinsics) {
  const bool all_zero = std::all_of(info.d.begin(), info.d.end(), [](double d) { return d == 0.0; });
  if (!all_zero && info.distortion_model != "plumb_bob") {
    return "distortion model \"" + info.distortion_model + "\" (expected plumb_bob)";
  }
  if (!all_zero && info.d.size() != 4 && info.d.size() != 5) {
    return std::to_string(info.d.size()) + " distortion parameters (expected 4 or 5 for plumb_bob)";
  }
  intrinsics.width = static_cast<int>(std::min<std::uint32_t>(info.width, 1u << 30));
  intrinsics.height = static_cast<int>(std::min<std::uint32_t>(info.height, 1u << 30));
  intrinsics.fx = info.k[0];
  intrinsics.fy = info.k[4];
  intrinsics.cx = info.k[2];
  intrinsics.cy = info.k[5];
  if (!all_zero) {
    intrinsics.k1 = info.d[0];
    intrinsics.k2 = info.d[1];
    intrinsics.p1 = info.d[2];
    intrinsics.p2 = info.d[3];
    if (info.d.size() == 5) intrinsics.k3 = info.d[4];
  }
  return checkIntrinsics(intrinsics);
}

/// A stamp that goes back by more begins a new epoch: a restarted clock, not messages out of order.
inline constexpr StampUs kClockBackUs = 1'000'000;

/// Number of messages, in the order of recording, before the clock jumps back; all where it does not.
template <typename Item>
std::size_t countBeforeJump(const std::vector<Item>& items) {
  StampUs newest_us = std::numeric_limits<StampUs>::min();
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0 && items[i].stamp_us < newest_us - kClockBackUs) return i;
    newest_us = std::max(newest_us, items[i].stamp_us);
  }
  return items.size();
}

/// Sorts by stamp and drops what is not newer than the one before.
template <typename Sample>
void makeIncreasing(std::vector<Sample>& samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.stamp_us < b.stamp_us; });
  samples.erase(std::unique(samples.begin(), samples.end(),
                            [](const Sample& a, const Sample& b) { return a.stamp_us == b.stamp_us; }),
                samples.end());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].seq = i;
}

}  // namespace vismem
