#include "active_visual_memory/core/gaze/gaze_requests.h"

#include <cmath>
#include <cstdio>

#include "active_visual_memory/core/gaze/attention.h"
#include "active_visual_memory/core/gaze/gaze_controller.h"

namespace vismem {

PortReply GazeRequestQueue::setMode(GazeMode mode) {
  if (mode == GazeMode::kFixate && !has_fixation_) {
    return PortReply::rejected("nothing was fixated so far: give a place first");
  }
  push([mode](GazeController& gaze, AttentionPool&) { gaze.setMode(mode); });
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
  push([p_odom](GazeController& gaze, AttentionPool&) { gaze.fixate(p_odom); });
  return PortReply::accepted();
}

PortReply GazeRequestQueue::request(const GazeRequest& request) {
  std::string problem = checkGazeRequest(request);
  if (problem.empty() && request.p_odom) problem = problemOf(*request.p_odom);
  if (problem.empty() && status_ && request.deadline_us < status_->stamp_us) {
    problem = "deadlineUs = " + std::to_string(request.deadline_us) + " has passed (the newest image has " +
              std::to_string(status_->stamp_us) + ")";
  }
  if (!problem.empty()) return PortReply::rejected(problem);
  push([request](GazeController&, AttentionPool& pool) { pool.request(request); });
  return PortReply::accepted();
}

PortReply GazeRequestQueue::withdraw(const std::string& client, const std::string& key) {
  if (std::string problem = checkGazeClient(client, key); !problem.empty())
    return PortReply::rejected(problem);
  push([client, key](GazeController&, AttentionPool& pool) { pool.withdraw(client, key); });
  return PortReply::accepted();
}

std::vector<GazeRequestQueue::Item> GazeRequestQueue::take() {
  return std::exchange(items_, {});
}

}  // namespace vismem
