#include "mapper/core/seen_circles.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "common/geometry/plane.h"
#include "common/geometry/projection.h"
#include "common/memory/scratch.h"

namespace vismem {

std::array<Eigen::Vector2d, 2> SeenChord::cuts() const {
  const Eigen::Vector2d half = 0.5 * kArcCut * (floor.b - floor.a);
  return {floor.middle() - half, floor.middle() + half};
}

bool SeenChord::turnsLeftAbout(const Eigen::Vector2d& centre) const {
  return cross2(floor.middle() - centre, floor.b - floor.a) > 0.0;
}

bool SeenChord::coversFrom(const Eigen::Vector2d& centre, const Eigen::Vector2d& direction) const {
  const Eigen::Vector2d a = floor.a - centre;
  const Eigen::Vector2d b = floor.b - centre;
  return cross2(a, direction) * cross2(direction, b) > 0.0 && direction.dot(a + b) > 0.0;
}

double SeenCircle::width_m(double least_share) const {
  if (std::min(count[0], count[1]) < least_share * (count[0] + count[1])) return 0.0;
  return radius_m[1] - radius_m[0];
}

double SeenCircle::middleRadius(double least_share) const {
  if (width_m(least_share) != 0.0) return 0.5 * (radius_m[0] + radius_m[1]);
  return count[0] > count[1] ? radius_m[0] : radius_m[1];
}

std::vector<SeenChord> seenChords(const DriveRecord& record, const MapState& state,
                                  const SeenCircleParams& params) {
  std::map<std::pair<int, int>, double> lines;
  for (const LineLandmark& landmark : state.landmarks) {
    for (const LineLandmark::Seen& seen : landmark.seen) {
      double& line_m = lines[{seen.keyframe, seen.sighting}];
      line_m = std::max(line_m, landmark.segment().length());
    }
  }
  std::vector<SeenChord> chords;
  for (int k = 0; k < static_cast<int>(record.keyframes.size()); ++k) {
    const Keyframe& keyframe = record.keyframes[static_cast<std::size_t>(k)];
    const Pose3 T_world_camera = cameraOf(record, state, k);
    const auto place = [&](const Eigen::Vector2d& at) {
      return backProjectToGround(keyframe.intrinsics, T_world_camera, at, params.farthest_m);
    };
    for (int s = 0; s < static_cast<int>(keyframe.sightings.size()); ++s) {
      const LineSighting& sighting = keyframe.sightings[static_cast<std::size_t>(s)];
      const Label& label = record.elements.at(sighting.element).label;
      if (label == kUnknownLabel) continue;
      const Segment2& px = sighting.px;
      const auto a = place(px.a);
      const auto b = place(px.b);
      const auto nearer = place(px.middle() + Eigen::Vector2d::UnitY());
      const auto middle = place(px.middle());
      if (!a || !b || !nearer || !middle) continue;
      const auto line = lines.find({k, s});
      chords.push_back({{k, s},
                        sighting.element,
                        label,
                        {a->head<2>(), b->head<2>()},
                        std::max(params.least_sigma_m, (*middle - *nearer).norm()),
                        line != lines.end() ? line->second : 0.0});
    }
  }
  return chords;
}

namespace {

/// The guess of one image is rough: chords from so much further off count first.
constexpr double kWidest = 3.0;

bool isChordOf(const SeenChord& chord, const SeenCircle& circle, double edge_distance_m,
               const CircleMarkingParams& params) {
  if (chord.label != circle.label) return false;
  const double radius = circle.radius_m[chord.turnsLeftAbout(circle.centre)];
  // A piece of a longer line is no chord.
  if (std::max(chord.floor.length(), chord.line_m) > params.max_chord_share * radius) return false;
  const Eigen::Vector2d radial = (chord.floor.middle() - circle.centre).normalized();
  const Eigen::Vector2d along = (chord.floor.b - chord.floor.a).normalized();
  if (std::abs(radial.dot(along)) > std::sin(params.edge_angle_rad)) return false;
  const auto cuts = chord.cuts();
  return std::all_of(cuts.begin(), cuts.end(), [&](const Eigen::Vector2d& p) {
    return std::abs((p - circle.centre).norm() - radius) <= edge_distance_m;
  });
}

/// Gauss-Newton over the chords' points, near views counting more.
/// @return false when the circle is none of the size looked for.
bool fit(const std::vector<SeenChord>& chords, const std::vector<bool>& taken, const SeenCircleParams& params,
         SeenCircle& circle) {
  constexpr int kSteps = 12;
  for (int step = 0; step < kSteps; ++step) {
    const double widest = std::max(1.0, kWidest - step);
    Eigen::Matrix4d A = 1e-6 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    circle.count = {};
    circle.chords.clear();
    for (std::size_t i = 0; i < chords.size(); ++i) {
      const SeenChord& chord = chords[i];
      if (taken[i] || !isChordOf(chord, circle, widest * params.chords.edge_distance_m, params.chords))
        continue;
      circle.chords.push_back(i);
      const bool is_left = chord.turnsLeftAbout(circle.centre);
      ++circle.count[is_left];
      for (const Eigen::Vector2d& p : chord.cuts()) {
        const Eigen::Vector2d n = (p - circle.centre).normalized();
        const double off = (p - circle.centre).norm() - circle.radius_m[is_left];
        const double scaled = off / (widest * params.kernel_m);
        const double weight = 1.0 / (chord.sigma_m * chord.sigma_m * (1.0 + scaled * scaled));
        Eigen::Vector4d J;
        J << n, is_left ? 0.0 : 1.0, is_left ? 1.0 : 0.0;
        A += weight * J * J.transpose();
        b += weight * off * J;
      }
    }
    const Eigen::LDLT<Eigen::Matrix4d> solver(A);
    const Eigen::Vector4d x = solver.solve(b);
    circle.centre += x.head<2>();
    circle.radius_m[0] += x[2];
    circle.radius_m[1] += x[3];
    for (const double radius : circle.radius_m) {
      if (!(radius >= params.proposal.min_radius_m && radius <= params.proposal.max_radius_m)) return false;
    }
  }
  return std::abs(circle.width_m(params.chords.edge_share)) <= params.proposal.max_line_width_m;
}

double coverageOf(const std::vector<SeenChord>& chords, const SeenCircle& circle, int least_sightings) {
  constexpr int kSteps = 72;
  int shown = 0;
  for (int step = 0; step < kSteps; ++step) {
    const double angle = 2.0 * std::numbers::pi * step / kSteps;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const auto seen = std::count_if(circle.chords.begin(), circle.chords.end(), [&](std::size_t i) {
      return chords[i].coversFrom(circle.centre, direction);
    });
    shown += seen >= least_sightings;
  }
  return static_cast<double>(shown) / kSteps;
}

/// What each image proposes from chords that belong to no circle yet.
std::vector<SeenCircle> proposals(const std::vector<SeenChord>& chords, const std::vector<bool>& taken,
                                  const SeenCircleParams& params) {
  std::vector<SeenCircle> found;
  std::vector<std::uint64_t> ids(chords.size());
  std::iota(ids.begin(), ids.end(), 0);
  Scratch scratch;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < chords.size(); begin = end) {
    scratch.release();
    FloorEdges edges(scratch.resource());
    for (end = begin; end < chords.size() && chords[end].seen.keyframe == chords[begin].seen.keyframe;
         ++end) {
      if (taken[end]) continue;
      if (auto edge = makeFloorEdge(chords[end].floor, chords[end].label, {&ids[end], 1}))
        edges.push_back(*edge);
    }
    for (const Primitive& circle : findCircles(edges, params.proposal, scratch.resource())) {
      SeenCircle proposed;
      proposed.label = chords[circle.segments.front()].label;
      proposed.centre = circle.centre;
      proposed.radius_m.fill(circle.radius_m);
      found.push_back(std::move(proposed));
    }
  }
  return found;
}

}  // namespace

std::vector<SeenCircle> findSeenCircles(const std::vector<SeenChord>& chords,
                                        const SeenCircleParams& params) {
  std::vector<SeenCircle> circles;
  std::vector<bool> taken(chords.size(), false);
  while (true) {
    std::optional<SeenCircle> best;
    for (SeenCircle& circle : proposals(chords, taken, params)) {
      if (!fit(chords, taken, params, circle)) continue;
      circle.coverage = coverageOf(chords, circle, params.least_sightings);
      if (circle.coverage < params.min_coverage) continue;
      if (!best || circle.coverage > best->coverage) best = std::move(circle);
    }
    if (!best) return circles;
    // What lies beside its line, by the errors between images, is no further circle.
    for (std::size_t i = 0; i < chords.size(); ++i) {
      const double beside_m = kWidest * params.chords.edge_distance_m;
      taken[i] = taken[i] || isChordOf(chords[i], *best, beside_m, params.chords);
    }
    circles.push_back(std::move(*best));
  }
}

}  // namespace vismem
