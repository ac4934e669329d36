#include "active_visual_memory/core/primitives/primitive_tracker.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"

namespace vismem {
namespace {

/// Rotates the corners of a finding into the order of the known ones.
void alignVertices(const Primitive& known, Primitive& found) {
  const std::size_t n = known.vertices.size();
  if (found.vertices.size() != n || n == 0) return;
  const auto distance = [&](std::size_t shift) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += (known.vertices[i] - found.vertices[(shift + i) % n]).norm();
    return sum;
  };
  std::size_t shift = 0;
  // The ends of an arrow differ.
  for (std::size_t s = 1; s < n && known.kind != PrimitiveKind::kArrow; ++s) {
    if (distance(s) < distance(shift)) shift = s;
  }
  std::rotate(found.vertices.begin(), found.vertices.begin() + static_cast<std::ptrdiff_t>(shift),
              found.vertices.end());
  if (found.hidden_vertex >= 0) {
    found.hidden_vertex = static_cast<int>((static_cast<std::size_t>(found.hidden_vertex) + n - shift) % n);
  }
}

}  // namespace

void PrimitiveTracker::take(Entry& entry, const Primitive& seen, double dt_s) const {
  Primitive found = seen;
  Primitive& known = entry.value;
  ++entry.findings;
  const double weight = std::max(params_.smoothing, 1.0 / entry.findings);
  alignVertices(known, found);
  // An inferred corner does not move an observed one, unless its sides no longer point there: then the
  // observation was wrong.
  const auto hidden = static_cast<std::size_t>(std::max(0, found.hidden_vertex));
  const bool was_seen =
      found.hidden_vertex >= 0 && known.hidden_vertex < 0 &&
      (found.vertices[hidden] - known.vertices[hidden]).norm() <= params_.finder.polygons.corner_gap_m;
  for (std::size_t i = 0; i < known.vertices.size(); ++i) {
    if (was_seen && i == hidden) continue;
    known.vertices[i] += weight * (found.vertices[i] - known.vertices[i]);
  }
  known.centre += weight * (found.centre - known.centre);
  known.length_m += weight * (found.length_m - known.length_m);
  known.width_m += weight * (found.width_m - known.width_m);
  known.radius_m += weight * (found.radius_m - known.radius_m);
  const double turn = known.kind == PrimitiveKind::kArrow
                          ? angleDifference(found.heading_rad, known.heading_rad)
                          : 0.5 * angleDifference(2.0 * found.heading_rad, 2.0 * known.heading_rad);
  known.heading_rad = wrapAngle(known.heading_rad + weight * turn);
  known.quality += weight * (found.quality - known.quality);
  // An observed corner stays known; until then the hypothesis follows the findings.
  known.hidden_vertex = was_seen ? -1 : found.hidden_vertex;
  known.segments = found.segments;
  known.life = std::min(params_.max_life, known.life + params_.gain_per_s * dt_s);
}

const Segment2* PrimitiveTracker::find(const Places& places, std::uint64_t segment) {
  const auto place = std::ranges::lower_bound(places, segment, {}, &Place::segment);
  return place != places.end() && place->segment == segment ? &place->odom : nullptr;
}

void PrimitiveTracker::follow(Primitive& shape) const {
  // A small prior on no motion makes the problem regular.
  constexpr double kRest = 1e-3;
  Eigen::Matrix3d normal = kRest * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const std::uint64_t segment : shape.segments) {
    const Segment2* const before = find(before_, segment);
    const Segment2* const now = find(places_, segment);
    if (!before || !now) continue;
    const Eigen::Vector2d along = (now->b - now->a).normalized();
    const Eigen::Vector2d across = turned90(along);
    for (const Eigen::Vector2d& p : {before->a, before->b}) {
      const Eigen::Vector2d arm = p - shape.centre;
      const Eigen::Vector3d row(across.x(), across.y(), across.dot(turned90(arm)));
      normal += row * row.transpose();
      right += across.dot(now->a - p) * row;
    }
  }
  const Eigen::Vector3d motion = normal.ldlt().solve(right);
  const Eigen::Rotation2Dd turn(motion.z());
  const Eigen::Vector2d centre = shape.centre;
  const auto moved = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(centre + motion.head<2>() + turn * (p - centre));
  };
  for (auto& v : shape.vertices) v = moved(v);
  shape.centre = moved(centre);
  shape.heading_rad = wrapAngle(shape.heading_rad + motion.z());
}

PrimitiveTracker::PrimitiveTracker(const Params& params) : params_(params) {
  // A room's memory has fewer: the lists do not grow while the robot drives.
  constexpr std::size_t kShapes = 128;
  constexpr std::size_t kSegments = 1024;
  entries_.reserve(kShapes);
  published_.reserve(kShapes);
  hypotheses_.reserve(kShapes);
  places_.reserve(kSegments);
  before_.reserve(kSegments);
}

bool PrimitiveTracker::update(StampUs stamp_us, std::span<const MemorySegment> segments) {
  if (has_last_ && stamp_us >= last_us_ && stamp_us - last_us_ < params_.interval_us) return false;
  const double dt_s = has_last_ && stamp_us > last_us_ ? std::min(1.0, toSeconds(stamp_us - last_us_))
                                                       : toSeconds(params_.interval_us);
  has_last_ = true;
  last_us_ = stamp_us;

  scratch_.release();
  const Shapes found = findPrimitives(segments, params_.finder, scratch_.resource());
  std::pmr::vector<bool> taken(found.size(), false, scratch_.resource());
  before_.swap(places_);
  places_.clear();
  for (const MemorySegment& segment : segments) places_.push_back({segment.id, segment.odom.floor()});
  std::ranges::sort(places_, {}, &Place::segment);
  for (Entry& entry : entries_) {
    int best = -1;
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (taken[i] || !sameShape(entry.value, found[i], params_.finder)) continue;
      const double distance = (found[i].centre - entry.value.centre).norm();
      if (distance < nearest) {
        nearest = distance;
        best = static_cast<int>(i);
      }
    }
    if (best >= 0) {
      taken[best] = true;
      take(entry, found[best], dt_s);
      entry.value.last_seen_us = stamp_us;
      continue;
    }
    follow(entry.value);
    const auto alive = std::ranges::count_if(
        entry.value.segments, [&](std::uint64_t segment) { return find(places_, segment) != nullptr; });
    if (2 * alive < static_cast<std::ptrdiff_t>(entry.value.segments.size())) {
      entry.value.life -= params_.loss_per_s * dt_s;
    }
  }
  std::erase_if(entries_, [](const Entry& entry) { return entry.value.life <= 0.0; });
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (taken[i]) continue;
    Primitive& shape = entries_.emplace_back(Entry{found[i], 1}).value;
    shape.id = next_id_++;
    shape.life = params_.gain_per_s * dt_s;
    shape.first_seen_us = shape.last_seen_us = stamp_us;
  }
  publish();
  return true;
}

void PrimitiveTracker::publish() {
  published_.clear();
  hypotheses_.clear();
  for (const Entry& entry : entries_) {
    const Primitive& shape = entry.value;
    if (shape.life < params_.published_life) continue;
    published_.push_back(shape);
    if (shape.hidden_vertex < 0) continue;
    hypotheses_.push_back({shape.id, shape.vertices[static_cast<std::size_t>(shape.hidden_vertex)]});
  }
}

std::pmr::vector<SideCompletion> PrimitiveTracker::completions(std::pmr::memory_resource* scratch) const {
  const PolygonParams& polygons = params_.finder.polygons;
  const double reach = polygons.broken_offset_m + polygons.corner_gap_m;
  std::pmr::vector<SideCompletion> completions(scratch);
  for (const Primitive& shape : published_) {
    if (shape.kind != PrimitiveKind::kParallelogram && shape.kind != PrimitiveKind::kTriangle) continue;
    const std::size_t n = shape.vertices.size();
    for (std::size_t i = 0; i < n; ++i) {
      SideCompletion completion{{shape.vertices[i], shape.vertices[(i + 1) % n]}, {}};
      const Segment2& side = completion.side;
      for (const std::uint64_t segment : shape.segments) {
        const Segment2* const place = find(places_, segment);
        if (!place || lineAngleDifference(place->direction(), side.direction()) > polygons.parallel_rad)
          continue;
        if (distanceToLine(place->middle(), side) <= reach) completion.segments.push_back(segment);
      }
      if (completion.segments.size() >= 2) completions.push_back(completion);
    }
  }
  return completions;
}

void PrimitiveTracker::clear() {
  entries_.clear();
  places_.clear();
  publish();
  has_last_ = false;
}

}  // namespace vismem
