#include "mapper/core/landmarks.h"

#include <cmath>

#include "active_visual_memory/core/ground/camera_tilt.h"
#include "common/geometry/plane.h"

namespace vismem {

Eigen::Vector2d LineLandmark::along() const {
  const double angle = direction_rad + line[1];
  return {std::cos(angle), std::sin(angle)};
}

Eigen::Vector2d LineLandmark::pointAt(double t_m) const {
  const Eigen::Vector2d u = along();
  return reference + line[0] * turned90(u) + t_m * u;
}

void LineLandmark::recentre() {
  const double middle = 0.5 * (a.t_m + b.t_m);
  const Eigen::Vector2d at = pointAt(middle);
  direction_rad += line[1];
  reference = at;
  line = {0.0, 0.0};
  a.t_m -= middle;
  b.t_m -= middle;
}

namespace {

LineLandmark landmarkOf(std::uint64_t id, const ElementSummary& element) {
  LineLandmark landmark;
  landmark.id = 100 * id;
  landmark.elements = {id};
  landmark.label = element.label;
  landmark.dropped = element.dropped;
  landmark.anchor = element.last_keyframe;
  landmark.reference = element.robot.middle();
  landmark.direction_rad = element.robot.direction();
  const double half = 0.5 * element.robot.length();
  landmark.a = {-half, !element.censored_a};
  landmark.b = {half, !element.censored_b};
  return landmark;
}

}  // namespace

Pose3 cameraOf(const DriveRecord& record, const MapState& state, int keyframe) {
  const auto k = static_cast<std::size_t>(keyframe);
  CameraTilt tilt = state.camera_tilt;
  tilt.head<2>() += state.frame_tilts[k];
  return toPose3(state.poses[k]) * tilted(record.keyframes[k].T_robot_camera, tilt);
}

MapState initialState(const DriveRecord& record, const LandmarkParams& params) {
  MapState state;
  if (record.keyframes.empty()) return state;
  const Pose2 T_world_odom = inverse(record.keyframes.front().T_odom_robot);
  for (const Keyframe& keyframe : record.keyframes) {
    state.poses.push_back(T_world_odom * keyframe.T_odom_robot);
    state.frame_tilts.emplace_back(Eigen::Vector2d::Zero());
  }
  std::map<std::uint64_t, std::size_t> index_of;
  for (const auto& [id, element] : record.elements) {
    const bool usable =
        (element.confirmed || !params.confirmed_only) &&
        element.sightings >= (element.confirmed ? params.min_sightings : params.min_unconfirmed) &&
        element.robot.length() >= params.min_length_m;
    if (!usable) continue;
    index_of[id] = state.landmarks.size();
    state.landmarks.push_back(landmarkOf(id, element));
  }
  for (std::size_t k = 0; k < record.keyframes.size(); ++k) {
    const auto& sightings = record.keyframes[k].sightings;
    for (std::size_t s = 0; s < sightings.size(); ++s) {
      const auto found = index_of.find(sightings[s].element);
      if (found == index_of.end()) continue;
      state.landmarks[found->second].seen.push_back({static_cast<int>(k), static_cast<int>(s)});
    }
  }
  return state;
}

}  // namespace vismem
