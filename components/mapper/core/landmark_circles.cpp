#include "mapper/core/landmark_circles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// One circle in the making.
class Circle {
 public:
  Circle(const std::vector<SeenChord>& chords, const CircleJoinParams& params, const SeenCircle& seen,
         MapState& state)
      : params_(params), state_(state), chords_(chords), seen_(seen) {
    const double edge_share = params_.seen.chords.edge_share;
    shape_.kind = PrimitiveKind::kCircle;
    shape_.centre = seen_.centre;
    shape_.radius_m = seen_.middleRadius(edge_share);
    shape_.width_m = std::abs(seen_.width_m(edge_share));
  }

  /// Adds it, and removes landmarks of which most sightings are its chords, and what remains of its line.
  void take(const DriveRecord& record) {
    state_.circles.push_back(landmarkOf(record));
    std::set<std::pair<int, int>> used;
    for (const std::size_t i : seen_.chords)
      used.insert({chords_[i].seen.keyframe, chords_[i].seen.sighting});
    std::erase_if(state_.landmarks, [&](const LineLandmark& landmark) {
      const auto mine = std::count_if(landmark.seen.begin(), landmark.seen.end(), [&](const auto& seen) {
        return used.count({seen.keyframe, seen.sighting}) > 0;
      });
      const bool is_member = mine > 0 && static_cast<double>(mine) >=
                                             params_.least_share * static_cast<double>(landmark.seen.size());
      return is_member || isLeftover(landmark);
    });
  }

  /// Adds the chords of the last one of MapState::circles.
  void addChords() {
    std::set<std::uint64_t> ids;
    for (const LineLandmark& landmark : state_.landmarks) ids.insert(landmark.id);
    for (const Segment2& world : regularChords()) {
      LineLandmark chord = chordAt(world);
      if (static_cast<int>(chord.seen.size()) < params_.seen.least_sightings) continue;
      while (!ids.insert(chord.id).second) ++chord.id;
      state_.landmarks.push_back(std::move(chord));
    }
  }

 private:
  /// On both edges, where it was seen and between.
  std::vector<Segment2> regularChords() const {
    std::vector<MemorySegment> segments = usedSegments();
    LineWidths widths;
    if (shape_.width_m > 0.0) widths[seen_.label] = seen_.width_m(params_.seen.chords.edge_share);
    constexpr int kMost = 1000;
    Primitive circle = shape_;
    regularizeCircle(segments, circle, widths, params_.seen.chords,
                     [](int n, int edge) { return static_cast<std::uint64_t>(edge * kMost + n); });
    std::vector<Segment2> chords;
    for (const MemorySegment& segment : segments) {
      if (std::binary_search(circle.segments.begin(), circle.segments.end(), segment.id))
        chords.push_back(segment.odom.floor());
    }
    return chords;
  }

  std::vector<MemorySegment> usedSegments() const {
    constexpr std::uint64_t kAboveChords = 1'000'000;
    std::vector<MemorySegment> segments;
    for (const std::size_t i : seen_.chords) {
      const SeenChord& chord = chords_[i];
      MemorySegment segment;
      segment.id = kAboveChords + segments.size();
      segment.odom.a << chord.floor.a, 0.0;
      segment.odom.b << chord.floor.b, 0.0;
      segment.label = seen_.label;
      segment.life = 1.0 / chord.sigma_m;
      segment.confirmed = true;
      segments.push_back(std::move(segment));
    }
    return segments;
  }

  bool isLeftover(const LineLandmark& landmark) const {
    if (landmark.label != seen_.label || landmark.isChord()) return false;
    const Segment2 world = state_.worldSegment(landmark);
    const Eigen::Vector2d radial = (world.middle() - seen_.centre).normalized();
    if (std::abs(radial.dot((world.b - world.a).normalized())) > std::sin(params_.seen.chords.edge_angle_rad))
      return false;
    const double half_m = 0.5 * shape_.width_m + params_.leftover_m;
    constexpr std::array kShares{0.0, 0.25, 0.5, 0.75, 1.0};
    const bool is_near = std::all_of(kShares.begin(), kShares.end(), [&](double share) {
      const Eigen::Vector2d p = world.a + share * (world.b - world.a);
      return std::abs((p - seen_.centre).norm() - shape_.radius_m) <= half_m;
    });
    return is_near && std::any_of(seen_.chords.begin(), seen_.chords.end(), [&](std::size_t i) {
             const Segment2& chord = chords_[i].floor;
             return (chord.middle() - world.middle()).norm() <= chord.length() + half_m;
           });
  }

  /// Sightings of a chord.
  std::vector<LineLandmark::Seen> seenAt(const Segment2& world) const {
    const Eigen::Vector2d n = (world.middle() - seen_.centre).normalized();
    const bool is_left = cross2(n, world.b - world.a) > 0.0;
    std::vector<LineLandmark::Seen> seen;
    for (const std::size_t i : seen_.chords) {
      const SeenChord& each = chords_[i];
      if (each.turnsLeftAbout(seen_.centre) == is_left && each.coversFrom(seen_.centre, n))
        seen.push_back(each.seen);
    }
    return seen;
  }

  LineLandmark chordAt(const Segment2& world) const {
    LineLandmark chord;
    chord.circle = static_cast<int>(state_.circles.size()) - 1;
    chord.label = seen_.label;
    chord.seen = seenAt(world);
    chord.anchor = state_.circles.back().anchor;
    std::set<std::uint64_t> elements;
    for (const std::size_t i : seen_.chords) elements.insert(chords_[i].element);
    chord.elements.assign(elements.begin(), elements.end());
    chord.id = 100 * chord.elements.front();
    const Segment2 local = transform(inverse(state_.poses[static_cast<std::size_t>(chord.anchor)]), world);
    chord.reference = local.middle();
    chord.direction_rad = local.direction();
    chord.a.t_m = -0.5 * local.length();
    chord.b.t_m = 0.5 * local.length();
    return chord;
  }

  /// Fixed to the keyframe that saw it last, as the lines are.
  CircleLandmark landmarkOf(const DriveRecord& record) const {
    CircleLandmark landmark;
    landmark.anchor = chords_[seen_.chords.back()].seen.keyframe;
    const Pose2& T_world_anchor = state_.poses[static_cast<std::size_t>(landmark.anchor)];
    landmark.centre = transform(inverse(T_world_anchor), seen_.centre);
    landmark.radius_m = seen_.radius_m;
    for (const std::size_t i : seen_.chords) {
      const SeenChord& chord = chords_[i];
      CircleLandmark::Seen seen{chord.seen, chord.turnsLeftAbout(seen_.centre), chord.sigma_m, {}};
      const Pose3 T_camera_world = cameraOf(record, state_, chord.seen.keyframe).inverse();
      const auto cuts = chord.cuts();
      std::transform(cuts.begin(), cuts.end(), seen.cuts.begin(), [&](const Eigen::Vector2d& cut) {
        const Eigen::Vector3d p = T_camera_world * Eigen::Vector3d(cut.x(), cut.y(), 0.0);
        return Eigen::Vector2d(p.head<2>() / p.z());
      });
      landmark.seen.push_back(seen);
    }
    return landmark;
  }

  const CircleJoinParams& params_;
  MapState& state_;
  const std::vector<SeenChord>& chords_;
  const SeenCircle& seen_;
  Primitive shape_;
};

int replaceCircles(const DriveRecord& record, const CircleJoinParams& params, bool add_chords,
                   MapState& state) {
  const std::vector<SeenChord> chords = seenChords(record, state, params.seen);
  state.circles.clear();
  for (const SeenCircle& seen : findSeenCircles(chords, params.seen)) {
    Circle circle(chords, params, seen, state);
    circle.take(record);
    if (add_chords) circle.addChords();
  }
  return static_cast<int>(state.circles.size());
}

}  // namespace

int takeCircles(const DriveRecord& record, const CircleJoinParams& params, MapState& state) {
  return replaceCircles(record, params, false, state);
}

int joinCircles(const DriveRecord& record, const CircleJoinParams& params, MapState& state) {
  return replaceCircles(record, params, true, state);
}

}  // namespace vismem
