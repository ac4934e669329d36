// SegmentMemory: ends of remembered lines, and gaps that split them.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "active_visual_memory/core/ground/line_gaps.h"
#include "active_visual_memory/core/memory/duplicates.h"
#include "active_visual_memory/core/memory/segment_memory_view.h"
#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

constexpr std::size_t kMaxGaps = 8;  // gaps of one line with votes
// Only straight lines are split: pieces of a chord over a curve turn with it.
constexpr double kMinSplitLength_m = 0.5;
constexpr double kStraight_rad = 0.1;
// An occluder at one place of a line, seen from directions that differ by this, stands there.
constexpr double kStandsThere_rad = 0.2;

// In a line a pixel or two wide, noise and blur look like gaps.
constexpr double kThin_px = 4.0;
constexpr double kThinGap_px = 4.0;
// A spot on a line, or a joining line, is about as wide as lines are.
constexpr double kMaxSpot_m = 0.15;

/// The antiparallel edge of a narrow line.
const ImageSegment* otherEdgeOf(const Segment2& px, const std::vector<ImageSegment>& observed) {
  const auto other = std::find_if(observed.begin(), observed.end(), [&](const ImageSegment& s) {
    return (s.px.b - s.px.a).dot(px.b - px.a) < 0.0 &&
           lineAngleDifference(s.px.direction(), px.direction()) <= kStraight_rad &&
           distanceToSegment(s.px.middle(), px) <= kThin_px;
  });
  return other != observed.end() ? &*other : nullptr;
}

double bearingDifference(const Eigen::Vector2d& at, const Eigen::Vector2d& one,
                         const Eigen::Vector2d& other) {
  return lineAngleDifference(std::atan2(at.y() - one.y(), at.x() - one.x()),
                             std::atan2(at.y() - other.y(), at.x() - other.x()));
}

}  // namespace

bool SegmentMemory::isFree(const Segment2& place, const MemoryElement& element, const View& view) const {
  const auto px = projectSegment(view.observation.frame.intrinsics, view.T_odom_camera, onFloor(place));
  return px && px->length() >= kMinVisible_px && element.colours &&
         view.evidence.classify(*px, *element.colours) == PlaceShows::kFree;
}

bool SegmentMemory::isOfAnotherKind(const Segment2& place, const MemoryElement& element,
                                    const std::vector<FloorSegment>& floor) const {
  const double length = place.length();
  return std::any_of(floor.begin(), floor.end(), [&](const FloorSegment& other) {
    if (labelsCompatible(other.label, element.value.label)) return false;
    if (!samePolarity(place, element.strength, other.odom(), other.strength)) return false;
    const Neighbourhood near = neighbourhood(place, other.odom());
    // Most of the place, or up to the border of the image.
    return near.distance_m <= params_.gates.near_distance_m && -near.gap_m >= std::min(0.5 * length, 0.3) &&
           lineAngle(place, other.odom()) <= kNearAngle_rad;
  });
}

void SegmentMemory::updateEndpoints(MemoryElement& element, std::span<const FloorSegment* const> seen,
                                    const std::vector<FloorSegment>& floor, const View& view) {
  // The extent in this image, from all its pieces.
  ExtentEnd low;
  ExtentEnd high;
  low.t_m = 1e9;
  high.t_m = -1e9;
  low.censored = high.censored = true;
  const Eigen::Vector2d u = element.line.along();
  for (const FloorSegment* piece : seen) {
    const FloorSegment s = runningAlong(u, *piece);
    const ExtentEnd a = element.line.project(s.a);
    const ExtentEnd b = element.line.project(s.b);
    if (a.t_m < low.t_m) low = a;
    if (b.t_m > high.t_m) high = b;
  }
  const auto review = [&](MemoryElement::ShortVotes& votes, const ExtentEnd& end, const ExtentEnd& at,
                          bool at_b) {
    const double inward = at_b ? end.t_m - at.t_m : at.t_m - end.t_m;
    const double gate = endGate(end.variance_m2, at.variance_m2, params_.line);
    if (at.censored || inward <= gate) {
      votes = {};
      return;
    }
    // Free floor behind it, or an edge of another label there, distinguishes a shorter line from an occluded
    // one.
    const Segment2 whole = element.line.segment();
    const Eigen::Vector2d known = at_b ? whole.b : whole.a;
    const Eigen::Vector2d stop = known + (at.t_m - end.t_m) * u;
    const Segment2 beyond = at_b ? Segment2{stop, known} : Segment2{known, stop};
    if (!isFree(beyond, element, view) && !isOfAnotherKind(beyond, element, floor)) return;
    votes.at = (votes.at * votes.count + stop) / (votes.count + 1);
    votes.variance_m2 = at.variance_m2;
    if (++votes.count < kShortVotes) return;
    element.line.shorten(
        at_b, {element.line.tOf(votes.at), votes.variance_m2, false, votes.variance_m2, 1, at.d_tilt});
    element.short_a = element.short_b = {};
  };
  review(element.short_a, element.line.endA(), low, false);
  review(element.short_b, element.line.endB(), high, true);
}

void SegmentMemory::split(const Associations& associations, const std::vector<ImageSegment>& observed,
                          const View& view) {
  if (params_.gap_votes <= 0 || params_.fusion != Fusion::kCovariance) return;
  for (std::size_t p = 0; p < associations.expected.size(); ++p) {
    const auto& pieces = associations.seen[p];
    if (!pieces.empty()) updateGaps(elements_[associations.index_of[p]], pieces, observed, view);
  }
  std::move(split_off_.begin(), split_off_.end(), std::back_inserter(elements_));
  split_off_.clear();
}

std::pmr::vector<SegmentMemory::Interruption> SegmentMemory::interruptionsOf(
    const MemoryElement& element, std::span<const FloorSegment> pieces,
    const std::vector<ImageSegment>& observed, const View& view) const {
  std::pmr::vector<Interruption> found(scratch_.resource());
  const auto& k = view.observation.frame.intrinsics;
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    const FloorSegment& before = pieces[i];
    const FloorSegment& behind = pieces[i + 1];
    if (lineAngleDifference(before.odom().direction(), behind.odom().direction()) > kStraight_rad) continue;
    const Segment2 between{before.b.p, behind.a.p};
    // The detector breaks lines, too: the image must show no edge there, or an occluder.
    const auto px = projectSegment(k, view.T_odom_camera, onFloor(between));
    if (!px) continue;
    const bool hidden = before.b.censored || behind.a.censored;
    if (!hidden && !view.evidence.isEdgeless(*px, kGapContrastShare * element.strength)) continue;
    const bool stands = hidden && view.evidence.gap(*px, 0.0, px->length()) == GapShows::kStandsThere;
    found.push_back({between, &before, &behind, hidden && !stands});
  }
  // The detector also closes gaps.
  for (const FloorSegment& piece : pieces) {
    const Segment2& px = observed[static_cast<std::size_t>(piece.observed)].px;
    const Eigen::Vector2d along = (px.b - px.a).normalized();
    auto gaps = findLineGaps(view.observation.frame.image, k, px, {}, scratch_.resource());
    std::pmr::vector<LineGap> bumps(scratch_.resource());
    if (const ImageSegment* other = otherEdgeOf(px, observed)) {
      std::erase_if(gaps, [](const LineGap& gap) { return gap.to_px - gap.from_px < kThinGap_px; });
      const bool outward_left = cross2(along, other->px.middle() - px.a) > 0.0;
      bumps = findLineBumps(view.observation.frame.image, k, px, outward_left, {}, scratch_.resource());
    }
    const auto add = [&](const LineGap& gap, double most_m) {
      if (view.evidence.gap(px, gap.from_px, gap.to_px) == GapShows::kOccluded) return;
      const auto placeOf = [&](double at_px) {
        return backProjectToGround(k, view.T_odom_camera, px.a + at_px * along, params_.gates.max_range_m);
      };
      const auto a = placeOf(gap.from_px);
      const auto b = placeOf(gap.to_px);
      if (!a || !b) return;
      Segment2 place{a->head<2>(), b->head<2>()};
      if (place.length() > most_m) return;
      if (element.line.along().dot(place.b - place.a) < 0.0) std::swap(place.a, place.b);
      found.push_back({place, &piece, &piece, false});
    };
    for (const LineGap& gap : gaps) add(gap, std::numeric_limits<double>::max());
    for (const LineGap& bump : bumps) add(bump, kMaxSpot_m);
  }
  return found;
}

void SegmentMemory::updateGaps(MemoryElement& element, std::span<const FloorSegment* const> seen,
                               const std::vector<ImageSegment>& observed, const View& view) {
  if (element.line.length() < kMinSplitLength_m) return;
  const Eigen::Vector2d u = element.line.along();
  std::pmr::vector<FloorSegment> pieces(scratch_.resource());
  for (const FloorSegment* piece : seen) pieces.push_back(runningAlong(u, *piece));
  std::sort(pieces.begin(), pieces.end(),
            [&](const FloorSegment& a, const FloorSegment& b) { return u.dot(a.a.p) < u.dot(b.a.p); });
  for (const Interruption& gap : interruptionsOf(element, pieces, observed, view)) {
    if (voteForGap(element, gap, view)) return;
  }
}

bool SegmentMemory::voteForGap(MemoryElement& element, const Interruption& seen, const View& view) {
  const Eigen::Vector2d u = element.line.along();
  const Eigen::Vector2d& from = seen.odom.a;
  const Eigen::Vector2d& to = seen.odom.b;
  if (u.dot(to - from) < params_.line.end_gate_m) return false;
  const double t_from = element.line.tOf(from);
  const double t_to = element.line.tOf(to);
  if (t_from <= element.line.endA().t_m || t_to >= element.line.endB().t_m) return false;
  // Each gap of a line has its own votes.
  auto& gaps = element.gaps;
  auto gap = std::find_if(gaps.begin(), gaps.end(), [&](const MemoryElement::GapVotes& known) {
    return (known.from - from).norm() <= kGapPlace_m && (known.to - to).norm() <= kGapPlace_m;
  });
  if (gap == gaps.end()) {
    if (gaps.size() >= kMaxGaps) gaps.erase(gaps.begin());
    gap = gaps.insert(gaps.end(), MemoryElement::GapVotes{});
    gap->camera = view.camera;
  }
  gap->bearing_spread_rad =
      std::max(gap->bearing_spread_rad, bearingDifference(0.5 * (from + to), gap->camera, view.camera));
  gap->from = (gap->from * gap->count + from) / (gap->count + 1);
  gap->to = (gap->to * gap->count + to) / (gap->count + 1);
  if (++gap->count < params_.gap_votes) return false;
  if (seen.may_be_hidden && gap->bearing_spread_rad < kStandsThere_rad) return false;
  const auto splitAt = [&](const Eigen::Vector2d& p, const FloorEnd& end_of_piece) {
    ExtentEnd end = element.line.project({p, end_of_piece.P, end_of_piece.D, false});
    end.views = params_.gap_votes;
    end.split = true;
    return end;
  };
  const ExtentEnd ends = splitAt(gap->from, seen.before->b);
  const ExtentEnd begins = splitAt(gap->to, seen.behind->a);
  gaps.erase(gap);
  element.short_a = element.short_b = {};
  MemoryElement other = element;
  other.value.id = next_id_++;
  other.line.shorten(false, begins);
  other.plane.parallax.forget(ParallaxEstimate::kEndA);
  element.line.shorten(true, ends);
  element.plane.parallax.forget(ParallaxEstimate::kEndB);
  publish(other);
  if (params_.estimation.enabled) map_filter_.copyLine(other.value.id, element.value.id);
  split_off_.push_back(std::move(other));
  return true;
}

}  // namespace vismem
