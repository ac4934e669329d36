#include "mapper/core/heading_alignment.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "active_visual_memory/core/estimation/dominant_direction.h"
#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// A line of one image in the frame of the robot.
struct SeenLine {
  double direction_rad = 0.0;
  double length_m = 0.0;
};

std::vector<SeenLine> linesOf(const Keyframe& keyframe, const HeadingParams& params) {
  std::vector<SeenLine> lines;
  for (const LineSighting& sighting : keyframe.sightings) {
    const auto a =
        backProjectToGround(keyframe.intrinsics, keyframe.T_robot_camera, sighting.px.a, params.range_m);
    const auto b =
        backProjectToGround(keyframe.intrinsics, keyframe.T_robot_camera, sighting.px.b, params.range_m);
    if (!a || !b) continue;
    const Segment2 floor{a->head<2>(), b->head<2>()};
    if (floor.length() >= params.least_m) lines.push_back({floor.direction(), floor.length()});
  }
  return lines;
}

/// Of the first stretch, which dead reckoning does not bend.
std::optional<double> dominantDirectionAtStart(const DriveRecord& record, const MapState& state,
                                               const std::vector<std::vector<SeenLine>>& lines,
                                               const HeadingParams& params) {
  DominantDirectionParams first;
  first.least_m = params.least_m;
  first.least_share = params.least_share;
  DominantDirection dominant(first);
  for (std::size_t k = 0; k < lines.size() && record.keyframes[k].way_m <= params.start_m; ++k) {
    for (const SeenLine& line : lines[k])
      dominant.add(line.direction_rad + state.poses[k].theta, line.length_m);
  }
  return dominant.direction();
}

}  // namespace

bool alignHeadings(const DriveRecord& record, const OdometryErrors& odometry, const HeadingParams& params,
                   MapState& state) {
  std::vector<std::vector<SeenLine>> lines;
  for (const Keyframe& keyframe : record.keyframes) lines.push_back(linesOf(keyframe, params));
  const auto dominant = dominantDirectionAtStart(record, state, lines, params);
  if (!dominant) return false;
  std::vector<double> corrections;
  double correction = 0.0;
  double variance = 0.0;
  double all_m = 0.0;
  double along_m = 0.0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (k > 0) {
      const double way = record.keyframes[k].way_m - record.keyframes[k - 1].way_m;
      const double turned = record.keyframes[k].turned_rad - record.keyframes[k - 1].turned_rad;
      const double feet = way + odometry.feet_per_rad_m * turned;
      variance += odometry.turn_noise * odometry.turn_noise * feet + std::pow(odometry.turn_per_m * way, 2) +
                  std::pow(odometry.turn_per_rad * turned, 2);
    }
    for (const SeenLine& line : lines[k]) {
      const double off =
          offDominantDirection(*dominant - state.poses[k].theta - correction, line.direction_rad);
      all_m += line.length_m;
      if (std::abs(off) > params.gate_rad) continue;
      if (std::abs(off) <= params.near_rad) along_m += line.length_m;
      const double gain = variance / (variance + params.line_rad * params.line_rad);
      correction += gain * off;
      variance *= 1.0 - gain;
    }
    corrections.push_back(correction);
  }
  if (all_m <= 0.0 || along_m < params.least_share * all_m) return false;
  const std::vector<Pose2> reckoned = state.poses;
  for (std::size_t k = 0; k < reckoned.size(); ++k) {
    const double theta = wrapAngle(reckoned[k].theta + corrections[k]);
    if (k == 0) continue;  // the frame of the drive
    const Pose2 step = inverse(reckoned[k - 1]) * reckoned[k];
    const Pose2 moved = state.poses[k - 1] * step;
    state.poses[k] = {moved.x, moved.y, theta};
  }
  return true;
}

std::optional<double> dominantDirectionOf(const MapState& state, double gate_rad, double least_share) {
  // The direction with most length within the gate, refined by a mean over four times the angle.
  std::vector<std::pair<double, double>> lines;  // direction, length
  double all = 0.0;
  for (const LineLandmark& landmark : state.landmarks) {
    if (landmark.isChord()) continue;
    const Segment2 segment = state.worldSegment(landmark);
    lines.emplace_back(segment.direction(), segment.length());
    all += segment.length();
  }
  double best = 0.0;
  std::optional<double> direction;
  for (const auto& [candidate, unused] : lines) {
    double length = 0.0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const auto& [angle, weight] : lines) {
      if (std::abs(std::sin(2.0 * (angle - candidate))) > 2.0 * gate_rad) continue;
      length += weight;
      sum += weight * Eigen::Vector2d(std::cos(4.0 * angle), std::sin(4.0 * angle));
    }
    if (length <= best) continue;
    best = length;
    direction = std::atan2(sum.y(), sum.x()) / 4.0;
  }
  return all > 0.0 && best >= least_share * all ? direction : std::nullopt;
}

}  // namespace vismem
