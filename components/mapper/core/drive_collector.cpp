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
constexpr double kPartOff_m = 0.04;  // of the ends of a part from the line
constexpr double kPartGap_m = 0.15;  // a line that joins is not wider

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

/// @param line  where the element is predicted.
MemorySegment ofParts(const PredictedSegment& predicted, const Segment2& line,
                      const MemorySnapshot& snapshot) {
  const double length = line.length();
  const Eigen::Vector2d along = (line.b - line.a) / length;
  std::vector<Reach> parts;
  double covered = 0.0;
  for (const MemorySegment& segment : snapshot.segments) {
    const Segment2 floor = segment.odom.floor();
    if (segment.label != predicted.label || (floor.b - floor.a).dot(along) <= 0.0) continue;
    if (lineAngleDifference(floor.direction(), line.direction()) > kPartAngle_rad) continue;
    const Reach reach{along.dot(floor.a - line.a), along.dot(floor.b - line.a)};
    const double overlap = std::min(reach.to_m, length) - std::max(reach.from_m, 0.0);
    if (overlap < -kPartGap_m || std::abs(cross2(along, floor.middle() - line.a)) > kPartOff_m) continue;
    parts.push_back(reach);
    if (segment.confirmed) covered += std::max(0.0, overlap);
  }
  const Reach whole = grown({0.0, length}, std::move(parts));
  const Eigen::Vector2d a = line.a + whole.from_m * along;
  const Eigen::Vector2d b = line.a + whole.to_m * along;
  MemorySegment element;
  element.id = predicted.id;
  element.label = predicted.label;
  element.odom = {{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}};
  element.confirmed = 2.0 * covered >= length;
  element.last_seen_us = snapshot.stamp_us;
  return element;
}

}  // namespace

std::vector<MemorySegment> elementsOf(const MemoryUpdate& update) {
  const ImageAnalysis& analysis = *update.analysis;
  std::vector<MemorySegment> elements = update.snapshot->segments;
  std::unordered_set<std::uint64_t> published;
  for (const MemorySegment& segment : elements) published.insert(segment.id);
  const Pose3 T_odom_camera = toPose3(analysis.T_odom_robot) * analysis.T_robot_camera;
  for (const ImageAnalysis::Match& match : analysis.matches) {
    const PredictedSegment& predicted = analysis.predicted[static_cast<std::size_t>(match.predicted)];
    if (published.count(predicted.id) > 0) continue;
    const auto a = backProjectToGround(analysis.intrinsics, T_odom_camera, predicted.px.a, kRange_m);
    const auto b = backProjectToGround(analysis.intrinsics, T_odom_camera, predicted.px.b, kRange_m);
    if (!a || !b || (*b - *a).norm() <= 0.0) continue;
    elements.push_back(ofParts(predicted, {a->head<2>(), b->head<2>()}, *update.snapshot));
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
