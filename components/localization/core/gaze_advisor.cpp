#include "localization/core/gaze_advisor.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"
#include "localization/core/robust_likelihood.h"

namespace vismem {
namespace {

constexpr double kNegligibleWeight = 0.01;  // of a race
/// A gaze in which this length of line tells the races apart scores half.
constexpr double kTellingLength_m = 0.5;
/// What one metre of line tells about the pose across it.
constexpr double kPointsPerMetre = 5.0;
constexpr double kPointSigma_m = 0.05;
constexpr double kFullInformation_nats = 2.0;  // information gain that counts 63 %
/// The health that a race at the right place has, when nothing is wrong.
constexpr double kGoodHealth = 0.8;
constexpr double kBadHealth = 0.4;
/// What a second look right after the first one is worth of it.
constexpr double kOldNews = 0.1;
/// That another place has such a line at just that place.
constexpr double kChanceOfLine = 0.2;

/// A robot stands on its way: ahead and behind there is room, and more to be seen than beside it.
double openness(double pan_rad) {
  return 0.5 + 0.5 * std::abs(std::cos(pan_rad));
}

double saturate(double value, double scale) {
  return 1.0 - std::exp(-value / scale);
}

Pose3 cameraTowards(const Eigen::Vector3d& position, const PanTilt& direction) {
  CameraMount mount;
  Pose3 T_robot_camera = cameraPose(mount, direction.pan_rad, direction.tilt_rad);
  T_robot_camera.translation() = position;
  return T_robot_camera;
}

std::vector<double> spread(double low, double high, double step) {
  const int count = std::max(1, static_cast<int>(std::lround((high - low) / step)) + 1);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(count == 1 ? 0.5 * (low + high) : low + (high - low) * i / (count - 1));
  }
  return values;
}

}  // namespace

PanTilt axisOf(const Pose3& T_robot_camera) {
  const Eigen::Vector3d axis = T_robot_camera.linear().col(2);
  return {std::atan2(axis.y(), axis.x()), std::atan2(axis.z(), axis.head<2>().norm())};
}

GazeAdvisor::GazeAdvisor(const GazeAdvisorParams& params, const LocalizerParams& localizer,
                         const SegmentMap& map_edges)
    : params_(params), map_(map_edges, robustIndex(localizer)), visible_(map_, localizer.opaque_labels) {}

void GazeAdvisor::look(const MemoryUpdate& update) {
  const ImageAnalysis& view = *update.analysis;
  if (view.intrinsics.width <= 0) return;
  const double bearing = axisOf(view.T_robot_camera).pan_rad + view.T_odom_robot.theta;
  const double half_width = std::atan(0.5 * view.intrinsics.width / view.intrinsics.fx);
  for (int i = 0; i < kBearings; ++i) {
    const double middle = 2.0 * std::numbers::pi * (i + 0.5) / kBearings;
    if (std::abs(angleDifference(middle, bearing)) < half_width) {
      seen_us_[static_cast<std::size_t>(i)] = view.stamp_us;
    }
  }
}

double GazeAdvisor::coverageOf(double bearing_odom, double half_width_rad, StampUs now_us) const {
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kBearings; ++i) {
    const double middle = 2.0 * std::numbers::pi * (i + 0.5) / kBearings;
    if (std::abs(angleDifference(middle, bearing_odom)) >= half_width_rad) continue;
    const auto& seen_us = seen_us_[static_cast<std::size_t>(i)];
    // A stamp ahead of now is from before a restart of the source.
    const bool is_known = seen_us && *seen_us <= now_us;
    sum += is_known ? saturate(toSeconds(now_us - *seen_us), params_.age_s) : 1.0;
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

std::vector<GazeAdvisor::Target> GazeAdvisor::targets(const PoseEstimate& estimate, double none) const {
  std::vector<const RaceReport*> races;
  for (const RaceReport& race : estimate.races) {
    if (race.weight >= kNegligibleWeight) races.push_back(&race);
  }
  std::vector<Target> all;
  std::vector<VisiblePoint> points;
  for (const RaceReport* race : races) {
    visible_.around(race->T_world_robot, params_.range_m, {}, nullptr, points);
    for (const VisiblePoint& point : points) {
      Target target;
      target.p_robot = point.p_robot;
      target.length = point.length_m;
      for (const RaceReport* other : races) {
        if (other == race) continue;
        const Pose2& T = other->T_world_robot;
        const auto field =
            map_.nearest(point.label, transform(T, point.p_robot), point.direction_robot + T.theta);
        const double d = field ? field->distance_m / params_.sigma_m : 1e9;
        target.disagreement += race->weight * other->weight * (1.0 - std::exp(-0.5 * d * d));
      }
      // What another place would show there is not known: probably no such line.
      target.disagreement = (1.0 - none) * target.disagreement + none * (1.0 - kChanceOfLine) * race->weight;
      target.disagreement *= 4.0 * point.length_m;  // two equal races that disagree fully: its length
      if (race->winner) {
        // How a shift of the pose moves the line across itself, in world.
        const double direction = point.direction_robot + race->T_world_robot.theta;
        const Eigen::Vector2d n(-std::sin(direction), std::cos(direction));
        const Eigen::Vector2d arm = transform(Pose2{0, 0, race->T_world_robot.theta}, point.p_robot);
        const Eigen::Vector3d J(n.x(), n.y(), -n.x() * arm.y() + n.y() * arm.x());
        target.information =
            kPointsPerMetre * point.length_m / (kPointSigma_m * kPointSigma_m) * J * J.transpose();
      }
      all.push_back(target);
    }
  }
  return all;
}

std::vector<GazeAdvice> GazeAdvisor::advise(const PoseEstimate& estimate, const MemoryUpdate& update) const {
  const ImageAnalysis& view = *update.analysis;
  const MemorySnapshot& snapshot = *update.snapshot;
  std::vector<GazeAdvice> advice;
  if (view.intrinsics.width <= 0) return advice;
  double best_health = 0.0;
  for (const RaceReport& race : estimate.races) best_health = std::max(best_health, race.health);
  const double none = std::clamp(1.0 - (best_health - kBadHealth) / (kGoodHealth - kBadHealth),
                                 std::min(params_.none_share, 1.0), 1.0);
  const std::vector<Target> seen = targets(estimate, none);
  const double half_width = std::atan(0.5 * view.intrinsics.width / view.intrinsics.fx);
  const PanTilt now = axisOf(view.T_robot_camera);
  const Eigen::Matrix3d P = estimate.P + 1e-8 * Eigen::Matrix3d::Identity();
  const Pose2 T_robot_odom = inverse(snapshot.T_odom_robot);
  const Eigen::Vector3d camera = view.T_robot_camera.translation();
  for (const double tilt : spread(params_.minimum_tilt_rad, params_.maximum_tilt_rad, params_.step_rad)) {
    for (const double pan : spread(params_.minimum_pan_rad, params_.maximum_pan_rad, params_.step_rad)) {
      GazeAdvice one;
      one.direction = {pan, tilt};
      const Pose3 T_robot_camera = cameraTowards(camera, one.direction);
      const CameraView shown(view.intrinsics, T_robot_camera);
      double telling = 0.0;
      Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
      for (const Target& target : seen) {
        if (!shown.shows(target.p_robot)) continue;
        telling += target.disagreement;
        information += target.information;
      }
      one.disagreement = telling / (telling + kTellingLength_m);
      const double nats = 0.5 * std::log((Eigen::Matrix3d::Identity() + P * information).determinant());
      one.information = saturate(std::max(0.0, nats), kFullInformation_nats);
      one.coverage = coverageOf(pan + snapshot.T_odom_robot.theta, half_width, snapshot.stamp_us);
      double age = 0.0;
      double length = 0.0;
      for (const MemorySegment& segment : snapshot.segments) {
        if (!shown.shows(transform(T_robot_odom, segment.odom.floor().middle()))) continue;
        const double unseen_s = std::max(0.0, toSeconds(snapshot.stamp_us - segment.last_seen_us));
        age += segment.odom.length() * saturate(unseen_s, params_.age_s);
        length += segment.odom.length();
      }
      if (length > 0.0) one.staleness = age / length;
      // The races were rated by what was seen there just now: it has told what it can.
      const double news = kOldNews + (1.0 - kOldNews) * one.coverage;
      const double gain = news * (params_.disagreement_weight * one.disagreement +
                                  (1.0 - none) * params_.information_weight * one.information) +
                          (params_.coverage_weight + none) * one.coverage * openness(pan) +
                          params_.staleness_weight * one.staleness;
      // Units stop at their limits, so no way leads behind the robot.
      const double way = std::max(std::abs(pan - now.pan_rad), std::abs(tilt - now.tilt_rad));
      one.score = gain / (params_.look_cost_s + way / params_.head_speed_radps);
      const Eigen::Vector3d axis = T_robot_camera.linear().col(2);
      const double to_floor = axis.z() < 0.0 ? -camera.z() / axis.z() : params_.aim_m;
      one.p_odom = transform(snapshot.T_odom_robot,
                             Eigen::Vector3d(camera + std::min(to_floor, params_.aim_m) * axis));
      advice.push_back(one);
    }
  }
  std::stable_sort(advice.begin(), advice.end(),
                   [](const GazeAdvice& a, const GazeAdvice& b) { return a.score > b.score; });
  return advice;
}

}  // namespace vismem
