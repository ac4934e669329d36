#include "mapper/core/drive_collector.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/plane.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr StampUs kUpdateEvery_us = 190'000;     ///< localization iterates at 5 Hz
constexpr StampUs kJustSeen_us = 2 * kSecondUs;  ///< races ask whether the memory is of now

}  // namespace

MemoryUpdate searchedPart(const MemoryUpdate& update, double range_m) {
  auto snapshot = std::make_shared<MemorySnapshot>();
  snapshot->stamp_us = update.snapshot->stamp_us;
  snapshot->revision = update.snapshot->revision;
  snapshot->epoch = update.snapshot->epoch;
  snapshot->T_odom_robot = update.snapshot->T_odom_robot;
  const Pose2 T_robot_odom = inverse(snapshot->T_odom_robot);
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(range_m);
  for (const MemorySegment& segment : update.snapshot->segments) {
    const bool is_near = clipToBox(transform(T_robot_odom, segment.odom.floor()), -reach, reach).has_value();
    if (is_near || segment.last_seen_us + kJustSeen_us >= snapshot->stamp_us)
      snapshot->segments.push_back(segment);
  }
  snapshot->segments.shrink_to_fit();
  auto analysis = std::make_shared<ImageAnalysis>(*update.analysis);
  analysis->predicted = {};
  analysis->matches = {};
  return {std::move(snapshot), std::move(analysis)};
}

namespace {

constexpr double kPartAngle_rad = 0.1;
/// Between the chords that were seen of a circle and the regular ones that are published instead.
constexpr double kChordAngle_rad = 0.2;
constexpr double kPartOff_m = 0.04;  // of the ends of a part from the line
constexpr double kPartGap_m = 0.15;  // a line that joins is not wider

/// Time unseen after which an element is forgotten; longer than KeyframeParams::dropped_s.
constexpr StampUs kKnown_us = 10 * kSecondUs;
constexpr double kRange_m = 6.0;  // of floor points that predictions show

/// An interval along a line [m].
struct Reach {
  double from_m;
  double to_m;
};

/// Joins the parts of a line that lie along it: those of `parts` that are reached from `reach` over gaps.
Reach grown(Reach reach, std::vector<Reach> parts) {
  std::sort(parts.begin(), parts.end(), [](const Reach& a, const Reach& b) { return a.from_m < b.from_m; });
  for (const Reach& part : parts) {
    if (part.from_m <= reach.to_m + kPartGap_m && part.to_m >= reach.from_m - kPartGap_m)
      reach.to_m = std::max(reach.to_m, part.to_m);
  }
  std::sort(parts.begin(), parts.end(), [](const Reach& a, const Reach& b) { return a.to_m > b.to_m; });
  for (const Reach& part : parts) {
    if (part.to_m >= reach.from_m - kPartGap_m && part.from_m <= reach.to_m)
      reach.from_m = std::min(reach.from_m, part.from_m);
  }
  return reach;
}

/// @param known  an element that is published in parts, where it was last matched.
MemorySegment ofParts(const MemorySegment& known, const std::vector<MemorySegment>& published) {
  const Segment2 line = known.odom.floor();
  const double length = line.length();
  const Eigen::Vector2d along = (line.b - line.a) / length;
  std::vector<Reach> parts;
  double confirmed = 0.0;
  for (const MemorySegment& segment : published) {
    const Segment2 floor = segment.odom.floor();
    if (segment.label != known.label || (floor.b - floor.a).dot(along) <= 0.0) continue;
    const double turn_rad = lineAngleDifference(floor.direction(), line.direction());
    if (turn_rad > kChordAngle_rad) continue;
    const Reach reach{along.dot(floor.a - line.a), along.dot(floor.b - line.a)};
    const double overlap = std::min(reach.to_m, length) - std::max(reach.from_m, 0.0);
    if (overlap < -kPartGap_m || std::abs(cross2(along, floor.middle() - line.a)) > kPartOff_m) continue;
    if (segment.confirmed) confirmed += std::max(0.0, overlap);
    if (turn_rad <= kPartAngle_rad) parts.push_back(reach);
  }
  const Reach whole = grown({0.0, length}, std::move(parts));
  const Eigen::Vector2d a = line.a + whole.from_m * along;
  const Eigen::Vector2d b = line.a + whole.to_m * along;
  MemorySegment element = known;
  element.odom = {{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}};
  element.confirmed = 2.0 * confirmed >= length;
  return element;
}

/// The memory predicts all that it has in view.
bool isInView(const MemorySegment& element, const ImageAnalysis& analysis, const Pose3& T_odom_camera) {
  constexpr double kLeast_px = 20.0;  // its place is known to some pixels only
  const auto whole = projectSegmentUnbounded(analysis.intrinsics, T_odom_camera, element.odom);
  const auto shown = projectSegment(analysis.intrinsics, T_odom_camera, element.odom);
  return whole && shown && shown->length() >= std::max(kLeast_px, 0.5 * whole->length());
}

}  // namespace

void PublishedElements::addMatched(const MemoryUpdate& update) {
  const ImageAnalysis& analysis = *update.analysis;
  const Pose3 T_odom_camera = toPose3(analysis.T_odom_robot) * analysis.T_robot_camera;
  for (const ImageAnalysis::Match& match : analysis.matches) {
    const PredictedSegment& predicted = analysis.predicted[static_cast<std::size_t>(match.predicted)];
    const auto a = backProjectToGround(analysis.intrinsics, T_odom_camera, predicted.px.a, kRange_m);
    const auto b = backProjectToGround(analysis.intrinsics, T_odom_camera, predicted.px.b, kRange_m);
    if (!a || !b || (*b - *a).norm() <= 0.0) continue;
    MemorySegment& element = known_[predicted.id];
    element.id = predicted.id;
    element.label = predicted.label;
    element.odom = {*a, *b};
    element.last_seen_us = update.snapshot->stamp_us;
  }
}

std::vector<MemorySegment> PublishedElements::of(const MemoryUpdate& update) {
  const MemorySnapshot& snapshot = *update.snapshot;
  if (snapshot.epoch != epoch_) known_.clear();
  epoch_ = snapshot.epoch;
  addMatched(update);
  std::unordered_set<std::uint64_t> published;
  for (const MemorySegment& segment : snapshot.segments) {
    published.insert(segment.id);
    known_[segment.id] = segment;
  }
  std::unordered_set<std::uint64_t> predicted;
  for (const PredictedSegment& each : update.analysis->predicted) predicted.insert(each.id);
  const Pose3 T_odom_camera = toPose3(update.analysis->T_odom_robot) * update.analysis->T_robot_camera;
  std::vector<MemorySegment> elements = snapshot.segments;
  std::erase_if(known_, [&](const auto& entry) {
    const auto& [id, element] = entry;
    if (published.count(id) > 0) return false;
    if (snapshot.stamp_us > element.last_seen_us + kKnown_us) return true;
    return predicted.count(id) == 0 && isInView(element, *update.analysis, T_odom_camera);
  });
  for (const auto& [id, element] : known_) {
    if (published.count(id) == 0) elements.push_back(ofParts(element, snapshot.segments));
  }
  return elements;
}

bool DriveCollector::add(const Frame& frame, const MemoryUpdate& update,
                         std::span<const MemorySegment> elements) {
  const bool is_keyframe = recorder_.add(frame, update, elements);
  const StampUs now_us = update.snapshot->stamp_us;
  const bool is_due = updates_.empty() || now_us >= updates_.back().snapshot->stamp_us + kUpdateEvery_us;
  if (is_due && !isBroken()) updates_.push_back(searchedPart(update, range_m_));
  return is_keyframe;
}

}  // namespace vismem
