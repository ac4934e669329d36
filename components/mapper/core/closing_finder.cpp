#include "mapper/core/closing_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// The landmarks that were not seen after a way, as a map.
SegmentMap mapBefore(const DriveRecord& record, const MapState& state, double way_m, double& length_m) {
  SegmentMap map;
  for (const LineLandmark& landmark : state.landmarks) {
    if (landmark.label == kUnknownLabel || landmark.seen.empty()) continue;
    const bool later = std::any_of(landmark.seen.begin(), landmark.seen.end(), [&](const auto& seen) {
      return record.keyframes[static_cast<std::size_t>(seen.keyframe)].way_m > way_m;
    });
    const Segment2 world = state.worldSegment(landmark);
    if (later || world.length() <= 0.0) continue;
    map.segments.push_back(
        {{{world.a.x(), world.a.y(), 0.0}, {world.b.x(), world.b.y(), 0.0}}, landmark.label});
    length_m += world.length();
  }
  return map;
}

/// Lead of the winner in nats; empty without one.
std::optional<double> leadOf(const PoseEstimate& estimate, const RaceReport*& winner) {
  double others = 0.0;
  winner = nullptr;
  for (const RaceReport& race : estimate.races) {
    if (race.winner) {
      winner = &race;
    } else {
      others = std::max(others, race.weight);
    }
  }
  if (!winner || winner->weight <= 0.0) return std::nullopt;
  constexpr double kLeast = 1e-9;
  return std::log(winner->weight / std::max(kLeast, others));
}

class Search {
 public:
  Search(const DriveRecord& record, const MapState& state, const ClosingParams& params, double begin_m)
      : record_(record), state_(state), params_(params), oldest_m_(begin_m - params.apart_m) {}

  /// After an update at the way `way_m`.
  void add(const PoseEstimate& estimate, double way_m, ClosingEvidence& evidence,
           std::vector<Closing>& closings) {
    const RaceReport* winner = nullptr;
    const auto lead = leadOf(estimate, winner);
    if (!lead || !estimate.T_world_robot) {
      since_.reset();
      return;
    }
    if (*lead > evidence.best_lead_nats && winner->health > 0.0) {
      evidence.best_lead_nats = *lead;
      evidence.best_explained = winner->health;
    }
    const bool leads = *lead >= params_.lead_nats && winner->health >= params_.explained;
    if (!leads || winner->id != race_) {
      race_ = winner->id;
      since_.reset();
      last_closing_m_.reset();
    }
    if (!leads) return;
    if (!since_) since_ = estimate.stamp_us;
    const double lead_s = toSeconds(estimate.stamp_us - *since_);
    evidence.longest_lead_s = std::max(evidence.longest_lead_s, lead_s);
    if (lead_s < params_.lead_s) return;
    if (last_closing_m_ && way_m - *last_closing_m_ < params_.next_m) return;
    if (const auto closing = closingOf(estimate)) {
      closings.push_back(*closing);
      last_closing_m_ = way_m;
      ++evidence.closings;
    }
  }

 private:
  std::optional<Closing> closingOf(const PoseEstimate& estimate) const {
    Closing closing;
    closing.to = nearestInTime(estimate.stamp_us);
    const Keyframe& to = record_.keyframes[static_cast<std::size_t>(closing.to)];
    const Pose2 T_world_to = *estimate.T_world_robot * inverse(estimate.T_odom_robot) * to.T_odom_robot;
    double nearest = std::numeric_limits<double>::max();
    for (int k = 0; k < static_cast<int>(record_.keyframes.size()); ++k) {
      if (record_.keyframes[static_cast<std::size_t>(k)].way_m > oldest_m_) break;
      const double off =
          (state_.poses[static_cast<std::size_t>(k)].position() - T_world_to.position()).norm();
      if (off >= nearest) continue;
      nearest = off;
      closing.from = k;
    }
    constexpr double kReach_m = 4.0;  // of the camera: further away no keyframe saw the place
    if (nearest > kReach_m) return std::nullopt;
    const Pose2& T_world_from = state_.poses[static_cast<std::size_t>(closing.from)];
    closing.T_from_to = inverse(T_world_from) * T_world_to;
    closing.P = inFrameOf(T_world_from, estimate.P);
    return closing;
  }

  /// Position and heading, with a floor, in the axes of the older keyframe.
  Eigen::Matrix3d inFrameOf(const Pose2& T_world_from, const Eigen::Matrix3d& P_world) const {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-T_world_from.theta).toRotationMatrix();
    Eigen::Matrix3d P = R * P_world * R.transpose();
    P.diagonal() += Eigen::Vector3d(std::pow(params_.least_sigma_m, 2), std::pow(params_.least_sigma_m, 2),
                                    std::pow(params_.least_sigma_rad, 2));
    return P;
  }

  int nearestInTime(StampUs stamp_us) const {
    const auto after = std::lower_bound(record_.keyframes.begin(), record_.keyframes.end(), stamp_us,
                                        [](const Keyframe& k, StampUs stamp) { return k.stamp_us < stamp; });
    const auto index = static_cast<int>(after - record_.keyframes.begin());
    return std::clamp(index, 0, static_cast<int>(record_.keyframes.size()) - 1);
  }

  const DriveRecord& record_;
  const MapState& state_;
  const ClosingParams& params_;
  double oldest_m_;
  std::uint64_t race_ = 0;
  std::optional<StampUs> since_;
  std::optional<double> last_closing_m_;
};

/// Way at a stamp, from the keyframe before it.
double wayAt(const DriveRecord& record, StampUs stamp_us) {
  const auto after = std::upper_bound(record.keyframes.begin(), record.keyframes.end(), stamp_us,
                                      [](StampUs stamp, const Keyframe& k) { return stamp < k.stamp_us; });
  return after == record.keyframes.begin() ? 0.0 : std::prev(after)->way_m;
}

}  // namespace

std::vector<double> searchBegins(const DriveRecord& record, const ClosingParams& params) {
  std::vector<double> begins;
  const double whole_m = record.keyframes.empty() ? 0.0 : record.keyframes.back().way_m;
  for (double m = params.apart_m; m < whole_m; m += params.every_m) begins.push_back(m);
  return begins;
}

FoundClosings searchClosings(const DriveRecord& record, const std::vector<MemoryUpdate>& updates,
                             const MapState& state, const ClosingParams& params, std::uint64_t seed,
                             double begin_m) {
  FoundClosings found;
  found.evidence.way_m = begin_m;
  const SegmentMap map = mapBefore(record, state, begin_m - params.apart_m, found.evidence.map_m);
  if (found.evidence.map_m < params.least_map_m) return found;
  Localizer localizer(params.localizer, map, seed);
  Search search(record, state, params, begin_m);
  for (const MemoryUpdate& update : updates) {
    const double way_m = wayAt(record, update.snapshot->stamp_us);
    if (way_m < begin_m) continue;
    if (way_m > begin_m + params.search_m) break;
    search.add(localizer.update(update), way_m, found.evidence, found.closings);
  }
  return found;
}

}  // namespace vismem
