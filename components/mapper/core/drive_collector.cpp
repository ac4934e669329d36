#include "mapper/core/drive_collector.h"

#include <utility>

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

bool DriveCollector::add(const Frame& frame, const MemoryUpdate& update,
                         std::span<const MemorySegment> elements) {
  const bool is_keyframe = recorder_.add(frame, update, elements);
  const StampUs now_us = update.snapshot->stamp_us;
  const bool is_due = updates_.empty() || now_us >= updates_.back().snapshot->stamp_us + kUpdateEvery_us;
  if (is_due && !isBroken()) updates_.push_back(searchedPart(update, range_m_));
  return is_keyframe;
}

}  // namespace vismem
