#include "localization/core/gaze/gaze_advisor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kDirectionStep_rad = degToRad(15.0);  // between candidate directions
constexpr double kRange_m = 4.0;                       // largest range of expected lines
constexpr double kAim_m = 3.0;                         // largest distance of the gaze point from the camera
constexpr double kSigma_m = 0.1;  // scale of the difference between two races' predictions of a line
/// Least belief in a place without a race. It makes all lines informative, not only those that discriminate
/// between races.
constexpr double kNoneShare = 0.2;
constexpr double kHorizon_s = 1.5;  // length of the predicted head motion; views on the way count
constexpr double kForget_s = 8.0;   // time constant of the decay of the time in view
constexpr double kHeadAcceleration_radps2 = degToRad(1000.0);
constexpr double kDelay_s = 0.02;  // from the image until a new request turns the head

constexpr double kNegligibleBelief = 0.01;  // in a race
/// Health of a race at the true pose, and of a refuted one.
constexpr double kGoodHealth = 0.75;
constexpr double kBadHealth = 0.35;
/// Belief enters by its square root plus this: after a jump of the robot the right place has little belief
/// for a second.
constexpr double kLeastBelief = 0.02;
/// Least factor of a race that explains nothing.
constexpr double kRefuted = 0.02;
/// Informative length of a bearing without lines [m], times |cos| of its angle to the robot's heading: along
/// its path there is more free space than beside it.
constexpr double kOpenness_m = 0.02;
constexpr double kStep_s = 0.1;         // of the predicted head motion
constexpr double kAbandoned_s = 2.0;    // time in view of a bearing that is not reached
constexpr double kLongestView_s = 0.2;  // between two images

/// Calls `f` with the index of each bearing whose centre lies in a view.
template <typename F>
void forBearings(int bearings, double at_rad, double half_width_rad, F f) {
  const double width = 2.0 * std::numbers::pi / bearings;
  const auto first = static_cast<int>(std::ceil((at_rad - half_width_rad) / width - 0.5));
  const auto last = static_cast<int>(std::floor((at_rad + half_width_rad) / width - 0.5));
  for (int i = first; i <= last; ++i) f(static_cast<std::size_t>((i % bearings + bearings) % bearings));
}

Pose3 cameraTowards(const Eigen::Vector3d& position, const PanTilt& direction) {
  CameraMount mount;
  Pose3 T_robot_camera = cameraPose(mount, direction.pan_rad, direction.tilt_rad);
  T_robot_camera.translation() = position;
  return T_robot_camera;
}

/// Candidate directions from low to high, evenly spread.
std::vector<double> spread(double low, double high) {
  const int count = std::max(1, static_cast<int>(std::lround((high - low) / kDirectionStep_rad)) + 1);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(count == 1 ? 0.5 * (low + high) : low + (high - low) * i / (count - 1));
  }
  return values;
}

double halfWidth(const CameraIntrinsics& intrinsics) {
  return std::atan(0.5 * intrinsics.width / intrinsics.fx);
}

}  // namespace

PanTilt axisOf(const Pose3& T_robot_camera) {
  const Eigen::Vector3d axis = T_robot_camera.linear().col(2);
  return {std::atan2(axis.y(), axis.x()), std::atan2(axis.z(), axis.head<2>().norm())};
}

double angleBetweenAxes(const PanTilt& a, const PanTilt& b) {
  const double c = std::sin(a.tilt_rad) * std::sin(b.tilt_rad) +
                   std::cos(a.tilt_rad) * std::cos(b.tilt_rad) * std::cos(a.pan_rad - b.pan_rad);
  return std::acos(std::clamp(c, -1.0, 1.0));
}

GazeAdvisor::GazeAdvisor(const GazeAdvisorParams& params, const LikelihoodParams& likelihood,
                         const MapParams& map, const SegmentMap& map_edges)
    : params_(params), map_(map_edges, robustIndex(likelihood, map)), visible_(map_, map.opaque_labels) {}

void GazeAdvisor::reset() {
  seen_s_.fill(0.0);
}

void GazeAdvisor::addView(const MemoryUpdate& update) {
  const ImageAnalysis& view = *update.analysis;
  if (view.intrinsics.width <= 0) return;
  // A stamp goes back after a restart of the source.
  const double since_s = last_view_us_ ? toSeconds(view.stamp_us - *last_view_us_) : kStep_s;
  if (since_s < 0.0) reset();
  last_view_us_ = view.stamp_us;
  const double kept = std::exp(-std::max(0.0, since_s) / kForget_s);
  const double view_s = std::clamp(since_s, 0.0, kLongestView_s);
  const double pan = axisOf(view.T_robot_camera).pan_rad;
  pan_speed_radps_ = last_pan_rad_ && since_s > 0.0 && since_s <= kLongestView_s
                         ? std::clamp(angleDifference(pan, *last_pan_rad_) / since_s,
                                      -params_.head_speed_radps, params_.head_speed_radps)
                         : 0.0;
  last_pan_rad_ = pan;
  const double bearing = pan + view.T_odom_robot.theta;
  for (double& seen_s : seen_s_) seen_s *= kept;
  forBearings(kBearings, bearing, halfWidth(view.intrinsics), [&](std::size_t i) { seen_s_[i] += view_s; });
}

void GazeAdvisor::abandon(const PanTilt& direction, const MemoryUpdate& update) {
  const double bearing = direction.pan_rad + update.snapshot->T_odom_robot.theta;
  forBearings(kBearings, bearing, halfWidth(update.analysis->intrinsics),
              [&](std::size_t i) { seen_s_[i] += kAbandoned_s; });
}

std::vector<GazeAdvisor::Target> GazeAdvisor::targets(const PoseEstimate& estimate) const {
  struct Place {
    Pose2 T_world_robot;
    double belief = 0.0;
  };
  std::vector<Place> places;
  double sum = 0.0;
  double best_fit = 0.0;
  for (const RaceReport& race : estimate.races) {
    const double fit = std::clamp((race.health - kBadHealth) / (kGoodHealth - kBadHealth), kRefuted, 1.0);
    places.push_back({race.T_world_robot, (std::sqrt(race.weight) + kLeastBelief) * fit});
    sum += places.back().belief;
    best_fit = std::max(best_fit, fit);
  }
  for (Place& place : places) place.belief /= sum;
  std::erase_if(places, [](const Place& place) { return place.belief < kNegligibleBelief; });
  const double none = std::clamp(1.0 - best_fit, kNoneShare, 1.0);
  std::vector<Target> all;
  std::vector<VisiblePoint> points;
  for (const Place& place : places) {
    visible_.around(place.T_world_robot, kRange_m, points);
    for (const VisiblePoint& point : points) {
      // A place without a race is assumed not to show this line.
      double differs = none;
      for (const Place& other : places) {
        if (&other == &place) continue;
        const Pose2& T = other.T_world_robot;
        const auto field =
            map_.nearest(point.label, transform(T, point.p_robot), point.direction_robot + T.theta);
        const double d = field ? field->distance_m / kSigma_m : 1e9;
        differs += (1.0 - none) * other.belief * (1.0 - std::exp(-0.5 * d * d));
      }
      all.push_back({point.p_robot, place.belief * differs * point.length_m});
    }
  }
  return all;
}

GazeAdvisor::Bearings GazeAdvisor::informativeAt(double tilt_rad, const std::vector<Target>& targets,
                                                 const MemoryUpdate& update) const {
  const ImageAnalysis& view = *update.analysis;
  const double heading = update.snapshot->T_odom_robot.theta;
  // The range limits of the image are the same at every pan.
  const CameraView ahead(view.intrinsics, cameraTowards(view.T_robot_camera.translation(), {0.0, tilt_rad}));
  Bearings informative_m;
  for (int i = 0; i < kBearings; ++i) {
    const double bearing = 2.0 * std::numbers::pi * (i + 0.5) / kBearings;
    informative_m[static_cast<std::size_t>(i)] = kOpenness_m * std::abs(std::cos(bearing - heading));
  }
  for (const Target& target : targets) {
    if (!ahead.shows({target.p_robot.norm(), 0.0})) continue;
    const double bearing = std::atan2(target.p_robot.y(), target.p_robot.x()) + heading;
    const auto bin = static_cast<int>(std::floor(bearing / (2.0 * std::numbers::pi) * kBearings));
    informative_m[static_cast<std::size_t>((bin % kBearings + kBearings) % kBearings)] +=
        target.informative_m;
  }
  return informative_m;
}

double GazeAdvisor::informationOnTheWay(double from_rad, double to_rad, double heading_rad,
                                        double half_width_rad, const Bearings& informative_m) const {
  Bearings seen_s = seen_s_;
  double sum = 0.0;
  double at = from_rad;
  double speed = pan_speed_radps_;
  for (double t = kStep_s; t < kHorizon_s + 0.5 * kStep_s; t += kStep_s) {
    // Until a request takes effect the head keeps its speed; to turn back it brakes first.
    if (t > kDelay_s + 0.5 * kStep_s) {
      const double ahead = to_rad - at;
      const double braking = std::sqrt(2.0 * kHeadAcceleration_radps2 * std::abs(ahead));
      const double wanted =
          std::copysign(std::min({params_.head_speed_radps, braking, std::abs(ahead) / kStep_s}), ahead);
      const double change = kHeadAcceleration_radps2 * kStep_s;
      speed += std::clamp(wanted - speed, -change, change);
    }
    at = std::clamp(at + speed * kStep_s, std::min(params_.minimum_pan_rad, from_rad),
                    std::max(params_.maximum_pan_rad, from_rad));
    double information = 0.0;
    forBearings(kBearings, at + heading_rad, half_width_rad, [&](std::size_t i) {
      information += informative_m[i] / (1.0 + seen_s[i] / params_.half_novelty_s);
      seen_s[i] += kStep_s;
    });
    sum += information * std::exp(-t / params_.patience_s);
  }
  return sum;
}

std::vector<GazeAdvice> GazeAdvisor::advise(const PoseEstimate& estimate, const MemoryUpdate& update) const {
  const ImageAnalysis& view = *update.analysis;
  std::vector<GazeAdvice> advice;
  if (view.intrinsics.width <= 0) return advice;
  const std::vector<Target> seen = targets(estimate);
  const double half_width = halfWidth(view.intrinsics);
  const double heading = update.snapshot->T_odom_robot.theta;
  const double now = axisOf(view.T_robot_camera).pan_rad;
  const Eigen::Vector3d camera = view.T_robot_camera.translation();
  for (const double tilt : spread(params_.minimum_tilt_rad, params_.maximum_tilt_rad)) {
    const Bearings informative_m = informativeAt(tilt, seen, update);
    for (const double pan : spread(params_.minimum_pan_rad, params_.maximum_pan_rad)) {
      GazeAdvice one;
      one.direction = {pan, tilt};
      // The unit stops at its limits, so the motion does not pass behind the robot.
      one.score = informationOnTheWay(now, pan, heading, half_width, informative_m);
      int shown = 0;
      forBearings(kBearings, pan + heading, half_width, [&](std::size_t i) {
        ++shown;
        one.informative_m += informative_m[i];
        one.novelty += 1.0 / (1.0 + seen_s_[i] / params_.half_novelty_s);
      });
      if (shown > 0) one.novelty /= shown;
      const Eigen::Vector3d axis = cameraTowards(camera, one.direction).linear().col(2);
      const double to_floor = axis.z() < 0.0 ? -camera.z() / axis.z() : kAim_m;
      one.p_odom = transform(update.snapshot->T_odom_robot,
                             Eigen::Vector3d(camera + std::min(to_floor, kAim_m) * axis));
      advice.push_back(one);
    }
  }
  std::stable_sort(advice.begin(), advice.end(),
                   [](const GazeAdvice& a, const GazeAdvice& b) { return a.score > b.score; });
  return advice;
}

}  // namespace vismem
