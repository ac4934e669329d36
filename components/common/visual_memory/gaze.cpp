#include "common/visual_memory/gaze.h"

#include <cmath>
#include <initializer_list>
#include <utility>

namespace vismem {
namespace {

constexpr std::size_t kMaxNameLength = 100;

std::string checkName(const char* name, const std::string& value, bool may_be_empty) {
  if (value.empty() && !may_be_empty) return std::string(name) + " is empty";
  if (value.size() <= kMaxNameLength) return {};
  return std::string(name) + " has " + std::to_string(value.size()) + " characters (must be at most " +
         std::to_string(kMaxNameLength) + ")";
}

std::string checkFinite(std::initializer_list<std::pair<const char*, double>> fields) {
  for (const auto& [name, value] : fields) {
    if (!std::isfinite(value)) {
      return std::string(name) + " = " + std::to_string(value) + " (must be finite)";
    }
  }
  return {};
}

}  // namespace

std::string checkGazePlace(const Eigen::Vector3d& p_odom) {
  return checkFinite({{"place.x", p_odom.x()}, {"place.y", p_odom.y()}, {"place.z", p_odom.z()}});
}

std::string checkGazeClient(const std::string& client, const std::string& key) {
  std::string problem = checkName("client", client, false);
  if (problem.empty()) problem = checkName("key", key, true);
  return problem;
}

std::string checkGazeRequest(const GazeRequest& request) {
  std::string problem = checkGazeClient(request.client, request.key);
  if (!problem.empty()) return problem;
  if (!request.p_odom && !request.direction) return "neither a place nor a direction to look at";
  if (request.p_odom && request.direction) return "both a place and a direction to look at (must be one)";
  if (request.p_odom) problem = checkGazePlace(*request.p_odom);
  if (request.direction) {
    problem = checkFinite({{"direction.panRad", request.direction->pan_rad},
                           {"direction.tiltRad", request.direction->tilt_rad}});
  }
  if (!problem.empty()) return problem;
  if (!(request.priority > 0.0 && request.priority <= kMaxPriority)) {
    return "priority = " + std::to_string(request.priority) + " (must be > 0, at most 100)";
  }
  return {};
}

}  // namespace vismem
