#include "active_visual_memory/core/gaze/gaze_requests.h"

namespace vismem {

PortReply GazeRequestQueue::setMode(GazeMode mode) {
  if (mode == GazeMode::kFixate && !has_fixation_) {
    return PortReply::rejected("nothing was fixated so far: give a place first");
  }
  items_.push_back({Item::Kind::kMode, mode, Eigen::Vector3d::Zero(), {}});
  return PortReply::accepted();
}

PortReply GazeRequestQueue::fixate(const Eigen::Vector3d& p_odom) {
  if (std::string problem = checkGazePlace(p_odom); !problem.empty()) return PortReply::rejected(problem);
  has_fixation_ = true;
  items_.push_back({Item::Kind::kFixate, GazeMode::kFixate, p_odom, {}});
  return PortReply::accepted();
}

PortReply GazeRequestQueue::request(const GazeRequest& request) {
  if (std::string problem = checkGazeRequest(request); !problem.empty()) return PortReply::rejected(problem);
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
