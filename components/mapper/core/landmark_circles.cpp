#include "mapper/core/landmark_circles.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

/// A sighting on the floor of the world.
struct SeenChord {
  std::size_t landmark = 0;
  LineLandmark::Seen seen;
  Segment2 floor;
  double sigma_m = 0.0;  ///< across, of one pixel
  bool is_used = false;

  std::array<Eigen::Vector2d, 2> cuts() const {
    const Eigen::Vector2d half = 0.5 * kArcCut * (floor.b - floor.a);
    return {floor.middle() - half, floor.middle() + half};
  }
  bool turnsLeftAbout(const Eigen::Vector2d& centre) const {
    return cross2(floor.middle() - centre, floor.b - floor.a) > 0.0;
  }
};

std::vector<SeenChord> chordsOf(const DriveRecord& record, const MapState& state, const Label& label,
                                const CircleJoinParams& params) {
  constexpr double kFarthest_m = 8.0;
  std::vector<SeenChord> chords;
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    const LineLandmark& landmark = state.landmarks[i];
    if (landmark.label != label || landmark.is_chord) continue;
    for (const LineLandmark::Seen& seen : landmark.seen) {
      const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(seen.keyframe)];
      const Segment2& px = keyframe.sightings[static_cast<std::size_t>(seen.sighting)].px;
      const Pose3 T_world_camera = cameraOf(record, state, seen.keyframe);
      const auto place = [&](const Eigen::Vector2d& at) {
        return backProjectToGround(keyframe.intrinsics, T_world_camera, at, kFarthest_m);
      };
      const auto a = place(px.a);
      const auto b = place(px.b);
      const auto nearer = place(px.middle() + Eigen::Vector2d::UnitY());
      const auto middle = place(px.middle());
      if (!a || !b || !nearer || !middle) continue;
      const double sigma_m = std::max(params.least_sigma_m, (*middle - *nearer).norm());
      chords.push_back({i, seen, {a->head<2>(), b->head<2>()}, sigma_m});
    }
  }
  return chords;
}

/// Centre and the radii of the edges whose brighter side lies outside (0) and inside (1).
struct Ring {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  std::array<double, 2> radius_m{};
  std::array<int, 2> chords{};
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();

  /// Where one edge was hardly seen, the other one alone is the circle.
  double width_m(double least_share) const {
    const double all = chords[0] + chords[1];
    if (std::min(chords[0], chords[1]) < least_share * all) return 0.0;
    return radius_m[1] - radius_m[0];  // > 0: bright
  }
  double middleRadius(double least_share) const {
    if (width_m(least_share) != 0.0) return 0.5 * (radius_m[0] + radius_m[1]);
    return chords[0] > chords[1] ? radius_m[0] : radius_m[1];
  }
};

bool isChordOf(const SeenChord& chord, const Ring& ring, const CircleMarkingParams& params) {
  const double radius = ring.radius_m[chord.turnsLeftAbout(ring.centre)];
  if (chord.floor.length() > params.max_chord_share * radius) return false;
  const Eigen::Vector2d radial = (chord.floor.middle() - ring.centre).normalized();
  const Eigen::Vector2d along = (chord.floor.b - chord.floor.a).normalized();
  if (std::abs(radial.dot(along)) > std::sin(params.edge_angle_rad)) return false;
  const auto cuts = chord.cuts();
  return std::all_of(cuts.begin(), cuts.end(), [&](const Eigen::Vector2d& p) {
    return std::abs((p - ring.centre).norm() - radius) <= params.edge_distance_m;
  });
}

/// Gauss-Newton over the chords' points, near views counting more. Sets which chords are of the ring.
void fit(std::vector<SeenChord>& chords, const CircleJoinParams& params, Ring& ring) {
  constexpr int kSteps = 10;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix4d A = 1e-6 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    ring.chords = {};
    for (SeenChord& chord : chords) {
      chord.is_used = isChordOf(chord, ring, params.chords);
      if (!chord.is_used) continue;
      const bool is_left = chord.turnsLeftAbout(ring.centre);
      ++ring.chords[is_left];
      for (const Eigen::Vector2d& p : chord.cuts()) {
        const Eigen::Vector2d n = (p - ring.centre).normalized();
        const double off = (p - ring.centre).norm() - ring.radius_m[is_left];
        const double scaled = off / params.kernel_m;
        const double weight = 1.0 / (chord.sigma_m * chord.sigma_m * (1.0 + scaled * scaled));
        Eigen::Vector4d J;
        J << n, is_left ? 0.0 : 1.0, is_left ? 1.0 : 0.0;
        A += weight * J * J.transpose();
        b += weight * off * J;
      }
    }
    const Eigen::LDLT<Eigen::Matrix4d> solver(A);
    const Eigen::Vector4d x = solver.solve(b);
    ring.P = solver.solve(Eigen::Matrix4d::Identity());
    ring.centre += x.head<2>();
    ring.radius_m[0] += x[2];
    ring.radius_m[1] += x[3];
  }
}

std::vector<FloorEdge> edgesOf(const MapState& state) {
  std::vector<FloorEdge> edges;
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    const LineLandmark& landmark = state.landmarks[i];
    if (landmark.label == kUnknownLabel || landmark.is_chord) continue;
    if (auto edge = makeFloorEdge(state.worldSegment(landmark), landmark.label, {i})) edges.push_back(*edge);
  }
  return edges;
}

/// The label of most of the members' length.
Label labelOf(const Primitive& circle, const MapState& state) {
  std::map<Label, double> lengths;
  for (const std::uint64_t i : circle.segments)
    lengths[state.landmarks[i].label] += state.worldSegment(state.landmarks[i]).length();
  const auto most = std::max_element(lengths.begin(), lengths.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most->first;
}

/// One circle in the making.
class Circle {
 public:
  Circle(const DriveRecord& record, const CircleJoinParams& params, const Primitive& found, Label label,
         MapState& state)
      : params_(params), state_(state), label_(std::move(label)), circle_(found) {
    chords_ = chordsOf(record, state, label_, params);
    ring_.centre = found.centre;
    ring_.radius_m.fill(found.radius_m);
    // The finder does not say which edge is which: the chords that fit do.
    fit(chords_, params, ring_);
  }

  bool replace() {
    const double width = ring_.width_m(params_.chords.edge_share);
    circle_.centre = ring_.centre;
    circle_.radius_m = ring_.middleRadius(params_.chords.edge_share);
    circle_.width_m = std::abs(width);
    circle_.segments.clear();
    std::vector<MemorySegment> segments = usedSegments();
    LineWidths widths;
    if (width != 0.0) widths[label_] = width;
    constexpr int kMost = 1000;
    regularizeCircle(segments, circle_, widths, params_.chords,
                     [](int n, int edge) { return static_cast<std::uint64_t>(edge * kMost + n); });
    std::vector<Segment2> chords;
    for (const MemorySegment& segment : segments) {
      const auto& published = circle_.segments;
      if (std::binary_search(published.begin(), published.end(), segment.id) &&
          static_cast<int>(seenAt(segment.odom.floor()).size()) >= params_.least_sightings)
        chords.push_back(segment.odom.floor());
    }
    const std::vector<std::size_t> members = membersAt(chords);
    if (chords.empty() || members.empty()) return false;
    const LineLandmark anchor = take(members);
    for (const Segment2& chord : chords) addChord(chord, anchor);
    return true;
  }

 private:
  std::vector<MemorySegment> usedSegments() const {
    constexpr std::uint64_t kAboveChords = 1'000'000;
    std::vector<MemorySegment> segments;
    for (const SeenChord& chord : chords_) {
      if (!chord.is_used) continue;
      MemorySegment segment;
      segment.id = kAboveChords + segments.size();
      segment.odom.a << chord.floor.a, 0.0;
      segment.odom.b << chord.floor.b, 0.0;
      segment.label = label_;
      segment.life = 1.0 / chord.sigma_m;
      segment.confirmed = true;
      segments.push_back(std::move(segment));
    }
    return segments;
  }

  bool isLeftover(const LineLandmark& landmark, const std::vector<Segment2>& chords) const {
    if (landmark.label != label_ || landmark.is_chord) return false;
    const Segment2 world = state_.worldSegment(landmark);
    const Eigen::Vector2d radial = (world.middle() - ring_.centre).normalized();
    if (std::abs(radial.dot((world.b - world.a).normalized())) > std::sin(params_.chords.edge_angle_rad))
      return false;
    const double half_m = 0.5 * circle_.width_m + params_.leftover_m;
    constexpr std::array kShares{0.0, 0.25, 0.5, 0.75, 1.0};
    const bool is_near = std::all_of(kShares.begin(), kShares.end(), [&](double share) {
      const Eigen::Vector2d p = world.a + share * (world.b - world.a);
      return std::abs((p - ring_.centre).norm() - circle_.radius_m) <= half_m;
    });
    return is_near && std::any_of(chords.begin(), chords.end(), [&](const Segment2& chord) {
             return (chord.middle() - world.middle()).norm() <= chord.length() + half_m;
           });
  }

  /// Landmarks of which most sightings are chords, and what remains of the circle's line.
  std::vector<std::size_t> membersAt(const std::vector<Segment2>& chords) const {
    std::vector<int> used(state_.landmarks.size(), 0);
    for (const SeenChord& chord : chords_) used[chord.landmark] += chord.is_used;
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < state_.landmarks.size(); ++i) {
      const auto seen = static_cast<double>(state_.landmarks[i].seen.size());
      if ((used[i] > 0 && used[i] >= params_.least_share * seen) || isLeftover(state_.landmarks[i], chords))
        members.push_back(i);
    }
    return members;
  }

  /// Removes landmarks. @return the one that was seen most.
  LineLandmark take(const std::vector<std::size_t>& members) {
    std::vector<LineLandmark> others;
    LineLandmark best;
    next_id_ = state_.landmarks[members.front()].id;
    for (std::size_t i = 0; i < state_.landmarks.size(); ++i) {
      LineLandmark& landmark = state_.landmarks[i];
      if (std::binary_search(members.begin(), members.end(), i)) {
        next_id_ = std::min(next_id_, landmark.id);
        if (landmark.seen.size() > best.seen.size()) best = landmark;
      } else {
        ids_.insert(landmark.id);
        others.push_back(std::move(landmark));
      }
    }
    state_.landmarks = std::move(others);
    return best;
  }

  /// Sightings of a chord.
  std::vector<LineLandmark::Seen> seenAt(const Segment2& chord) const {
    const Eigen::Vector2d n = (chord.middle() - ring_.centre).normalized();
    const bool is_left = cross2(n, chord.b - chord.a) > 0.0;
    std::vector<LineLandmark::Seen> seen;
    for (const SeenChord& each : chords_) {
      if (each.is_used && each.turnsLeftAbout(ring_.centre) == is_left && covers(each, n))
        seen.push_back(each.seen);
    }
    return seen;
  }

  void addChord(const Segment2& world, const LineLandmark& anchor) {
    LineLandmark chord;
    chord.is_chord = true;
    chord.label = label_;
    chord.elements = anchor.elements;
    chord.anchor = anchor.anchor;
    const Segment2 local = transform(inverse(state_.poses[static_cast<std::size_t>(anchor.anchor)]), world);
    chord.reference = local.middle();
    chord.direction_rad = local.direction();
    chord.a.t_m = -0.5 * local.length();
    chord.b.t_m = 0.5 * local.length();
    const Eigen::Vector2d n = (world.middle() - ring_.centre).normalized();
    const bool is_left = cross2(n, world.b - world.a) > 0.0;
    Eigen::Vector4d J;
    J << n, is_left ? 0.0 : 1.0, is_left ? 1.0 : 0.0;
    const double variance = J.dot(ring_.P * J);
    chord.P_line = Eigen::Vector2d(variance, variance / (circle_.radius_m * circle_.radius_m)).asDiagonal();
    chord.seen = seenAt(world);
    while (!ids_.insert(next_id_).second) ++next_id_;
    chord.id = next_id_;
    state_.landmarks.push_back(std::move(chord));
  }

  bool covers(const SeenChord& seen, const Eigen::Vector2d& direction) const {
    const Eigen::Vector2d a = seen.floor.a - ring_.centre;
    const Eigen::Vector2d b = seen.floor.b - ring_.centre;
    return cross2(a, direction) * cross2(direction, b) > 0.0 && direction.dot(a + b) > 0.0;
  }

  const CircleJoinParams& params_;
  MapState& state_;
  const Label label_;
  Primitive circle_;
  Ring ring_;
  std::vector<SeenChord> chords_;
  std::set<std::uint64_t> ids_;
  std::uint64_t next_id_ = 0;
};

}  // namespace

int joinCircles(const DriveRecord& record, const CircleJoinParams& params, MapState& state) {
  const std::vector<Primitive> circles = findCircles(edgesOf(state), params.finder);
  std::vector<Label> labels;  // first: the members are indices of landmarks
  for (const Primitive& circle : circles) labels.push_back(labelOf(circle, state));
  int joined = 0;
  for (std::size_t i = 0; i < circles.size(); ++i)
    joined += Circle(record, params, circles[i], labels[i], state).replace();
  return joined;
}

}  // namespace vismem
