#include "active_visual_memory/core/gaze/gaze_requests.h"

#include <cmath>
#include <cstdio>

namespace vismem {

PortReply GazeRequestQueue::setMode(GazeMode mode) {
  if (mode == GazeMode::kFixate && !has_fixation_) {
    return PortReply::rejected("nothing was fixated so far: give a place first");
  }
  items_.push_back({Item::Kind::kMode, mode, Eigen::Vector3d::Zero(), {}});
  return PortReply::accepted();
}

std::string GazeRequestQueue::problemOf(const Eigen::Vector3d& p_odom) const {
  const double distance_m = (p_odom.head<2>() - p_odom_robot_).norm();
  if (distance_m <= kFarthestPlace_m && std::abs(p_odom.z()) <= kFarthestPlace_m) return {};
  char text[120];
  std::snprintf(text, sizeof text, "place %.6g %.6g %.6g is %.6g m from the robot (must be within %.0f m)",
                p_odom.x(), p_odom.y(), p_odom.z(), std::hypot(distance_m, p_odom.z()), kFarthestPlace_m);
  return text;
}

PortReply GazeRequestQueue::fixate(const Eigen::Vector3d& p_odom) {
  std::string problem = checkGazePlace(p_odom);
  if (problem.empty()) problem = problemOf(p_odom);
  if (!problem.empty()) return PortReply::rejected(problem);
  has_fixation_ = true;
  items_.push_back({Item::Kind::kFixate, GazeMode::kFixate, p_odom, {}});
  return PortReply::accepted();
}

PortReply GazeRequestQueue::request(const GazeRequest& request) {
  std::string problem = checkGazeRequest(request);
  if (problem.empty() && request.p_odom) problem = problemOf(*request.p_odom);
  if (!problem.empty()) return PortReply::rejected(problem);
  items_.push_back({Item::Kind::kRequest, {}, Eigen::Vector3d::Zero(), request});
  return PortReply::accepted();
}

PortReply GazeRequestQueue::withdraw(const std::string& client, const std::string& key) {
  if (std::string problem = checkGazeClient(client, key); !problem.empty())
    return PortReply::rejected(problem);
  GazeRequest named;
  named.client = client;
  named.key = key;
  items_.push_back({Item::Kind::kWithdraw, {}, Eigen::Vector3d::Zero(), named});
  return PortReply::accepted();
}

std::vector<GazeRequestQueue::Item> GazeRequestQueue::take() {
  return std::exchange(items_, {});
}

}  // namespace vismem
