#include "mapper/core/landmark_corners.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "localization/core/map/visibility.h"

namespace vismem {
namespace {

/// One end of a landmark in world.
struct End {
  std::size_t landmark = 0;
  bool at_b = false;
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  Eigen::Vector2d outward = Eigen::Vector2d::UnitX();  ///< along the line
  bool closed = false;
  double length_m = 0.0;  ///< of its landmark
};

class Joiner {
 public:
  Joiner(const CornerJoinParams& params, MapState& state) : params_(params), state_(state) {
    for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
      if (state.landmarks[i].isChord()) continue;
      const Segment2 world = state.worldSegment(state.landmarks[i]);
      if (world.length() <= 0.0) continue;
      const Eigen::Vector2d u = (world.b - world.a) / world.length();
      ends_.push_back({i, false, world.a, -u, state.landmarks[i].a.closed, world.length()});
      ends_.push_back({i, true, world.b, u, state.landmarks[i].b.closed, world.length()});
    }
  }

  int join() {
    int moved = 0;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const auto& keep = params_.keep;
      if (std::find(keep.begin(), keep.end(), of(ends_[i]).id) != keep.end()) continue;
      std::optional<Corner> best;
      for (std::size_t j = 0; j < ends_.size(); ++j) {
        if (ends_[j].landmark == ends_[i].landmark) continue;
        const auto corner = cornerOf(ends_[i], ends_[j]);
        if (!corner || (best && std::abs(corner->outwards_m) >= std::abs(best->outwards_m))) continue;
        best = corner;
      }
      if (best) {
        moved += move(ends_[i], best->outwards_m, !best->is_hidden);
      } else {
        moved += joinFollowing(ends_[i]);
      }
    }
    return moved;
  }

 private:
  const LineLandmark& of(const End& end) const { return state_.landmarks[end.landmark]; }
  LandmarkEnd& endOf(const End& end) {
    LineLandmark& landmark = state_.landmarks[end.landmark];
    return end.at_b ? landmark.b : landmark.a;
  }

  bool formCorners(const LineLandmark& one, const LineLandmark& other) const {
    return one.label == other.label ||
           (matchesAny(one.label, params_.obstacles) && matchesAny(other.label, params_.obstacles));
  }

  struct Corner {
    double outwards_m = 0.0;
    bool is_hidden = false;  ///< no image saw it: the lines say where it is, and the ends stay bounds
  };
  /// The corner with the other end; empty without one.
  std::optional<Corner> cornerOf(const End& end, const End& other) const {
    const double sine = cross2(end.outward, other.outward);
    if (std::abs(sine) < std::sin(params_.least_angle_rad) || !formCorners(of(end), of(other)))
      return std::nullopt;
    const Eigen::Vector2d between = other.p - end.p;
    const double off = cross2(between, other.outward) / sine;
    const double off_other = cross2(between, end.outward) / sine;
    const bool is_hidden = !end.closed && !other.closed && matchesAny(of(end).label, params_.obstacles);
    const auto within = [&](const End& which, double outwards) {
      double most_m = which.closed ? params_.short_m : params_.reach_m;
      if (is_hidden) most_m = std::max(most_m, std::min(params_.open_m, params_.open_share * which.length_m));
      return outwards >= -params_.reach_m && outwards <= most_m;
    };
    if (!within(end, off) || !within(other, off_other)) return std::nullopt;
    return Corner{off, is_hidden && std::max(off, off_other) > params_.reach_m};
  }

  int move(const End& end, double outwards_m, bool is_seen = true) {
    LandmarkEnd& moved = endOf(end);
    moved.t_m += end.at_b ? outwards_m : -outwards_m;
    moved.closed = is_seen;
    return 1;
  }

  /// Edges of other labels in one line share the end where one passes into the other.
  int joinFollowing(const End& end) {
    for (const End& other : ends_) {
      if (other.landmark == end.landmark || of(other).label == of(end).label) continue;
      if (end.outward.dot(other.outward) > -std::cos(params_.angle_rad)) continue;
      const Eigen::Vector2d between = other.p - end.p;
      if (std::abs(cross2(end.outward, between)) > params_.across_m) continue;
      const double gap = end.outward.dot(between);
      if (std::abs(gap) > params_.gap_m) continue;
      // Closed ends count by their certainty, a bound not at all.
      const double mine = weightOf(end);
      const double its = weightOf(other);
      if (mine + its <= 0.0) continue;
      return move(end, gap * its / (mine + its));
    }
    return 0;
  }

  double weightOf(const End& end) const {
    if (!end.closed) return 0.0;
    return static_cast<double>(of(end).seen.size());
  }

  const CornerJoinParams& params_;
  MapState& state_;
  std::vector<End> ends_;  ///< as they were before
};

}  // namespace

int joinCorners(const CornerJoinParams& params, MapState& state) {
  return Joiner(params, state).join();
}

}  // namespace vismem
