// SegmentMemory: motion, merging, life and publication of elements.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/memory/duplicates.h"
#include "active_visual_memory/core/memory/segment_memory_view.h"
#include "common/geometry/plane.h"
#include "common/visual_memory/labels.h"

namespace vismem {
namespace {

constexpr double kMaxOffDirection_rad = 0.2;
constexpr double kMapFilterReach =
    2.0;  // factor of the merge distance in MapFilter, whose lines share their errors
constexpr double kMinSnapped_m = 0.03;  // of a confirmed edge in the dominant direction; shorter: a corner
constexpr double kMinFree_m = 0.1;      // of others, where edges snap to that direction

}  // namespace

void SegmentMemory::transformAll(const PlanarIncrement& motion) {
  if (motion.turn_rad() == 0.0 && motion.shift().isZero()) return;
  for (MemoryElement& element : elements_) {
    element.line.transform(motion);
    element.plane.transform(motion);
    for (MemoryElement::GapVotes& gap : element.gaps) {
      gap.from = motion.apply(gap.from);
      gap.to = motion.apply(gap.to);
      gap.camera = motion.apply(gap.camera);
    }
  }
}

std::optional<double> SegmentMemory::dominantDirection() const {
  DominantDirection place(params_.estimation.dominant_direction);
  for (const MemoryElement& element : elements_) {
    if (hasDirection(element)) place.add(element.line.direction(), element.line.length());
  }
  return place.direction();
}

void SegmentMemory::complete(std::span<const SideCompletion> sides) {
  std::pmr::vector<std::uint64_t> absorbed(scratch_.resource());
  for (const SideCompletion& side : sides) {
    MemoryElement* whole = nullptr;
    for (MemoryElement& element : elements_) {
      if (!std::binary_search(side.segments.begin(), side.segments.end(), element.value.id)) continue;
      if (std::count(absorbed.begin(), absorbed.end(), element.value.id) > 0) continue;  // of two shapes
      if (!whole) {
        whole = &element;
        continue;
      }
      if (!samePolarity(whole->line.segment(), whole->strength, element.line.segment(), element.strength))
        continue;
      join(*whole, element);
      absorbed.push_back(element.value.id);
    }
    if (whole) publish(*whole);
  }
  std::erase_if(elements_, [&](const MemoryElement& element) {
    return std::count(absorbed.begin(), absorbed.end(), element.value.id) > 0;
  });
}

void SegmentMemory::merge(const View& view) {
  if (view.turn_rate > kMaxMappingTurn_radps) return;
  mergeDuplicates(cache(view.observation.T_odom_robot));
}

bool SegmentMemory::areDuplicates(const MemoryElement& a, const MemoryElement& b, double reach_m) {
  const double turned = std::abs(cross2(a.line.along(), b.line.along()));  // a sine
  if (turned > std::sin(kNearAngle_rad) || !labelsCompatible(a.value.label, b.value.label)) return false;
  const auto goesBeyond = [](const MemoryElement& one, const MemoryElement& other) {
    if (!one.plane.isVerified() || !other.plane.mayBeVertical()) return false;
    const Segment2 s = other.line.segment();
    const auto [low, high] = std::minmax({one.line.tOf(s.a), one.line.tOf(s.b)});
    return low < one.line.endA().t_m - kMaxGap_m || high > one.line.endB().t_m + kMaxGap_m;
  };
  // A vertical edge crosses the foot of its wall, and would bend it.
  if (goesBeyond(a, b) || goesBeyond(b, a)) return false;
  const Segment2 sa = a.line.segment();
  const Segment2 sb = b.line.segment();
  if (!samePolarity(sa, a.strength, sb, b.strength)) return false;
  const bool a_longer = a.line.length() >= b.line.length();
  const Neighbourhood near = neighbourhood(a_longer ? sa : sb, a_longer ? sb : sa);
  if (near.gap_m > kMaxGap_m) return false;
  const double sigma = std::sqrt(a.line.offsetVariance(0.0) + b.line.offsetVariance(0.0));
  if (near.distance_m > std::min(reach_m, 0.02 + 3.0 * sigma)) return false;
  // Pieces that only touch end to end must have nearly one direction.
  if (near.gap_m > 0.0 && turned > std::sin(kDuplicateGateShare * kNearAngle_rad)) return false;
  return !areSplit(a.line, b.line);
}

void SegmentMemory::mergeDuplicates(std::span<const int> cached) {
  // Lines of one filter share their errors, so copies may lie further apart.
  const double reach = (params_.estimation.enabled ? kMapFilterReach : 1.0) * params_.gates.near_distance_m;
  struct Candidate {
    Eigen::AlignedBox2d box;
    int element;
    bool observed;
    bool gone;
  };
  // Only observed elements have changed: others are compared with observed ones, in their reach.
  Eigen::AlignedBox2d observed;
  for (const int i : cached) {
    if (elements_[i].sighting == Sighting::kObserved) observed.extend(boxAround(elements_[i].line.segment()));
  }
  std::pmr::vector<Candidate> candidates(scratch_.resource());
  candidates.reserve(cached.size());
  for (const int i : cached) {
    const Segment2 segment = elements_[i].line.segment();
    if (!boxAround(segment, kMaxGap_m + reach).intersects(observed)) continue;
    candidates.push_back({boxAround(segment), i, elements_[i].sighting == Sighting::kObserved, false});
  }
  const std::size_t count = candidates.size();
  std::pmr::vector<std::size_t> next_observed(count + 1, count, scratch_.resource());
  for (std::size_t n = count; n-- > 0;) {
    next_observed[n] = candidates[n].observed ? n : next_observed[n + 1];
  }
  std::pmr::vector<bool> gone(elements_.size(), false, scratch_.resource());
  for (std::size_t m = 0; m < count; ++m) {
    Candidate& a = candidates[m];
    if (a.gone) continue;
    MemoryElement& whole = elements_[a.element];
    Eigen::AlignedBox2d near = boxAround(whole.line.segment(), kMaxGap_m + reach);
    for (std::size_t n = m + 1; n < count; ++n) {
      if (!a.observed) n = next_observed[n];
      if (n == count) break;
      Candidate& b = candidates[n];
      if (b.gone || !near.intersects(b.box)) continue;
      if (!areDuplicates(whole, elements_[b.element], reach)) continue;
      join(whole, elements_[b.element]);
      gone[b.element] = b.gone = true;
      a.observed = true;
      near = boxAround(whole.line.segment(), kMaxGap_m + reach);
    }
  }
  // Elements are asked in their old places.
  std::erase_if(elements_, [&](const MemoryElement& element) { return gone[&element - elements_.data()]; });
}

void SegmentMemory::age(StampUs stamp_us) {
  const double dt = clock_.advance(stamp_us);
  if (dt > 0.0) {
    for (MemoryElement& element : elements_) {
      // Elements new since the last tick keep their initial life. An edge seen only along the viewing ray
      // may be vertical, and its floor place moves: out of view it decays faster.
      const bool suspect = element.plane.mayBeVertical();
      const bool unseen = element.sighting == Sighting::kOutOfView;
      element.value.life =
          agedLife(element.value.life, element.sighting,
                   suspect && unseen ? params_.retention.unverified_decay * dt : dt, params_.retention.life);
      element.sighting = Sighting::kAbsent;
    }
    std::erase_if(elements_,
                  [&](const MemoryElement& e) { return e.value.life < params_.retention.life.threshold; });
  }
  if (static_cast<int>(elements_.size()) > params_.retention.max_elements) {
    std::stable_sort(elements_.begin(), elements_.end(), [](const MemoryElement& a, const MemoryElement& b) {
      return a.value.life > b.value.life;
    });
    elements_.resize(static_cast<std::size_t>(params_.retention.max_elements));
    std::sort(elements_.begin(), elements_.end(),
              [](const MemoryElement& a, const MemoryElement& b) { return a.value.id < b.value.id; });
  }
}

void SegmentMemory::publish(MemoryElement& element) const {
  const bool named = params_.confirmation.unlabelled || element.value.label != kUnknownLabel;
  const double length = element.line.length();
  const double off = dominant_direction_rad_
                         ? offDominantDirection(element.line.direction(), *dominant_direction_rad_)
                         : 0.0;
  // A pixel at an end turns a line by this.
  const double inflation = std::min(kMaxOffDirection_rad, element.pixel_m / length);
  const bool snaps = dominant_direction_rad_ && std::abs(off) <= inflation;
  const double least = snaps ? kMinSnapped_m : kMinFree_m;
  const bool large = !params_.confirmation.by_parallax || !params_.confirmation.snap_to_dominant_direction ||
                     length >= least;
  vismem::publish(element, element.plane.on_floor && named && large, cameraTiltCovariance());
  if (params_.confirmation.by_parallax && !isLocated(element.value)) element.value.confirmed = false;
  if (!snaps) return;
  const Eigen::Vector2d middle = 0.5 * (element.value.odom.a + element.value.odom.b).head<2>();
  const Eigen::Vector2d half = 0.5 * length * (Eigen::Rotation2Dd(-off) * element.line.along());
  element.value.odom.a.head<2>() = middle - half;
  element.value.odom.b.head<2>() = middle + half;
}

void SegmentMemory::publishAll() {
  if (params_.confirmation.snap_to_dominant_direction) dominant_direction_rad_ = dominantDirection();
  for (MemoryElement& element : elements_) publish(element);
  if (!params_.confirmation.by_parallax) return;
  confirmContinuations(elements_, params_.confirmation.parallax.slopeLimit(camera_height_m_),
                       params_.confirmation.corners, scratch_.resource());
}

void SegmentMemory::advanceLife(StampUs stamp_us) {
  scratch_.release();
  // An image that is not analysed is no evidence.
  for (MemoryElement& element : elements_)
    element.sighting = std::max(element.sighting, Sighting::kOutOfView);
  age(stamp_us);
  publishAll();
}

}  // namespace vismem
