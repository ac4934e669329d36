#include "simulator/core/scene.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/kinematics/kinematics.h"
#include "simulator/core/props.h"
#include "simulator/core/renderer.h"

namespace vismem {
namespace {

constexpr std::size_t kMaxAdded = 1000;
constexpr double kMaxWalkingSpeed_mps = 10.0;
constexpr double kMaxPlace_m = 10'000.0;
/// Nearer way-points have no direction between them.
constexpr double kMinLine_m = 0.05;

bool isFinitePose(const Pose3& pose) {
  return pose.matrix().allFinite();
}

}  // namespace

std::string checkWay(const Way& way) {
  if (!(way.speed_mps > 0.0 && way.speed_mps <= kMaxWalkingSpeed_mps)) {
    return "speed " + std::to_string(way.speed_mps) + " m/s (must be above 0, at most " +
           std::to_string(kMaxWalkingSpeed_mps) + ")";
  }
  const auto& points = way.points;
  if (points.size() < 2) return std::to_string(points.size()) + " way-points (must be 2 or more)";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite() || points[i].cwiseAbs().maxCoeff() > kMaxPlace_m) {
      return "way-point " + std::to_string(i + 1) + " (must be finite, within 10 km)";
    }
    const bool joined = i + 1 < points.size() || way.closed;
    if (joined && (points[(i + 1) % points.size()] - points[i]).norm() < kMinLine_m) {
      return "way-point " + std::to_string(i + 1) + " (must be 0.05 m or more from the next)";
    }
  }
  return {};
}

MovingWorld::MovingWorld(const World& world) : models_(world.models), of_world_(world.models.size()) {
  // Of models in the renderer only poses and outlines are needed.
  for (auto& model : models_) model.bodies.clear();
  for (const auto& model : models_) now_.models.push_back({model.pose, true});
  changed();
}

void MovingWorld::changed() {
  ++revision_;
  shared_.reset();
  obstacles_.clear();
  for (std::size_t i = 0; i < models_.size(); ++i) {
    if (!now_.models[i].visible) continue;
    for (auto& obstacle : obstaclesAt(models_[i], now_.models[i].pose))
      obstacles_.push_back(std::move(obstacle));
  }
}

std::optional<int> MovingWorld::find(const std::string& name) const {
  const auto found =
      std::find_if(models_.begin(), models_.end(), [&](const auto& model) { return model.name == name; });
  if (found == models_.end()) return std::nullopt;
  return static_cast<int>(found - models_.begin());
}

std::optional<int> MovingWorld::findOrSay(const std::string& name, PortReply& reply) const {
  const auto model = find(name);
  if (!model) reply = PortReply::rejected("no model \"" + name + "\" in this world");
  return model;
}

std::vector<ModelStatus> MovingWorld::status() const {
  std::vector<ModelStatus> result;
  for (std::size_t i = 0; i < models_.size(); ++i) {
    const bool walks = std::any_of(walkers_.begin(), walkers_.end(),
                                   [&](const Walker& w) { return w.model == static_cast<int>(i); });
    result.push_back({models_[i].name, now_.models[i].pose, now_.models[i].visible, walks});
  }
  return result;
}

PortReply MovingWorld::add(const std::string& name, const PropShape& shape, const Pose3& T_world_model) {
  if (name.empty()) return PortReply::rejected("a model must have a name");
  if (const auto known = find(name)) {
    return PortReply::rejected("there is a model \"" + name + "\"" +
                               (now_.models[*known].visible ? "" : " (removed: placing it brings it back)"));
  }
  if (const auto problem = checkProp(shape); !problem.empty()) return PortReply::rejected(problem);
  if (!isFinitePose(T_world_model)) return PortReply::rejected("a pose must be finite");
  if (models_.size() - of_world_ >= kMaxAdded && !forgetRemoved()) {
    return PortReply::rejected("there are " + std::to_string(kMaxAdded) + " added models (remove one)");
  }
  models_.push_back(makeProp(name, shape, T_world_model));
  now_.models.push_back({T_world_model, true});
  changed();
  return PortReply::accepted();
}

bool MovingWorld::forgetRemoved() {
  std::vector<int> index(models_.size());  // of each model from now on
  std::size_t kept = 0;
  for (std::size_t i = 0; i < models_.size(); ++i) {
    index[i] = static_cast<int>(kept);
    if (i >= of_world_ && !now_.models[i].visible) continue;
    if (kept != i) models_[kept] = std::move(models_[i]);
    now_.models[kept++] = now_.models[i];
  }
  if (kept == models_.size()) return false;
  models_.resize(kept);
  now_.models.resize(kept);
  // Walking models are present.
  for (Walker& walker : walkers_) walker.model = index[walker.model];
  ++now_.layout;
  return true;
}

PortReply MovingWorld::remove(const std::string& name) {
  PortReply reply;
  const auto model = findOrSay(name, reply);
  if (!model) return reply;
  if (!now_.models[*model].visible) return PortReply::adjusted("\"" + name + "\" was away already");
  stopWalking(*model);
  now_.models[*model].visible = false;
  changed();
  return PortReply::accepted();
}

PortReply MovingWorld::place(const std::string& name, const Pose3& T_world_model) {
  PortReply reply;
  const auto model = findOrSay(name, reply);
  if (!model) return reply;
  if (!isFinitePose(T_world_model)) return PortReply::rejected("a pose must be finite");
  stopWalking(*model);
  now_.models[*model] = {T_world_model, true};
  changed();
  return PortReply::accepted();
}

PortReply MovingWorld::walk(const std::string& name, const Way& way) {
  PortReply reply;
  const auto model = findOrSay(name, reply);
  if (!model) return reply;
  if (const auto problem = checkWay(way); !problem.empty()) return PortReply::rejected(problem);
  stopWalking(*model);
  const Route route{way.points, way.closed};
  Walker walker{*model, route, way.speed_mps, way.at_end, 0.0, 1.0};
  if (now_.models[*model].visible) {
    walker.along_m = nearestPlace(route, now_.models[*model].pose.translation().head<2>()).along_m;
  }
  now_.models[*model] = {poseOf(walker), true};
  walkers_.push_back(std::move(walker));
  changed();
  return PortReply::accepted();
}

PortReply MovingWorld::stand(const std::string& name) {
  PortReply reply;
  if (const auto model = findOrSay(name, reply)) stopWalking(*model);
  return reply;
}

void MovingWorld::stopWalking(int model) {
  std::erase_if(walkers_, [model](const Walker& walker) { return walker.model == model; });
}

Pose3 MovingWorld::poseOf(const Walker& walker) const {
  const RoutePlace place = placeAlong(walker.route, walker.along_m);
  Pose3 pose = toPose3(Pose2{place.position.x(), place.position.y(),
                             wrapAngle(place.heading_rad + (walker.way < 0.0 ? std::numbers::pi : 0.0))});
  pose.translation().z() = now_.models[walker.model].pose.translation().z();
  return pose;
}

void MovingWorld::step(double dt_s, const Pose2& T_world_robot, double robot_radius_m) {
  if (walkers_.empty()) return;
  // Distance that walking models keep from the robot [m].
  constexpr double kClearance_m = 0.05;
  const auto gap = [&](int model, const Pose3& pose) {
    double nearest = 1e9;
    for (const auto& obstacle : obstaclesAt(models_[model], pose)) {
      nearest = std::min(nearest, distanceToOutline(T_world_robot.position(), obstacle.outline));
    }
    return nearest;
  };
  bool moved = false;
  std::vector<int> arrived;
  for (Walker& walker : walkers_) {
    Walker next = walker;
    next.along_m += walker.way * walker.speed_mps * dt_s;
    const double length = walker.route.length();
    if (walker.route.closed) {
      next.along_m = std::fmod(next.along_m + length, length);
    } else if (next.along_m < 0.0 || next.along_m > length) {
      next.along_m = std::clamp(next.along_m, 0.0, length);
      if (walker.at_end == WayEnd::kBack) {
        next.way = -walker.way;
      } else {
        arrived.push_back(walker.model);
      }
    }
    const Pose3 pose = poseOf(next);
    const double there = gap(walker.model, pose);
    if (there < robot_radius_m + kClearance_m && there < gap(walker.model, now_.models[walker.model].pose))
      continue;
    walker = next;
    now_.models[walker.model].pose = pose;
    moved = true;
  }
  for (const int model : arrived) stopWalking(model);
  if (moved) changed();
}

std::shared_ptr<const SceneState> MovingWorld::state() const {
  if (!shared_) shared_ = std::make_shared<const SceneState>(now_);
  return shared_;
}

void MovingWorld::show(const SceneState& wanted_state, Renderer& renderer, SceneState& shown) const {
  const SceneState& state = wanted_state.layout == now_.layout ? wanted_state : now_;
  for (std::size_t i = static_cast<std::size_t>(renderer.modelCount()); i < models_.size(); ++i) {
    renderer.addModel(models_[i]);
  }
  // Models of the world start at their pose in the world, added models at the pose of their addition.
  for (std::size_t i = shown.models.size(); i < models_.size(); ++i) {
    shown.models.push_back({models_[i].pose, true});
  }
  for (std::size_t i = 0; i < models_.size(); ++i) {
    // A frame older than a model does not show it.
    const SceneState::Model wanted =
        i < state.models.size() ? state.models[i] : SceneState::Model{shown.models[i].pose, false};
    const int index = static_cast<int>(i);
    if (!wanted.pose.isApprox(shown.models[i].pose, 0.0)) renderer.setModelPose(index, wanted.pose);
    if (wanted.visible != shown.models[i].visible) renderer.setModelVisible(index, wanted.visible);
    shown.models[i] = wanted;
  }
}

}  // namespace vismem
