// SegmentMemory: association of an image, update of the filters, correction of the memory.
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/memory/segment_memory_view.h"

namespace vismem {

SegmentMemory::Associations SegmentMemory::associatePlaced(const View& view,
                                                           const std::vector<ImageSegment>& observed,
                                                           const std::vector<FloorSegment>& floor,
                                                           std::span<const FloorSegment> placed) const {
  std::pmr::vector<int> floor_of(observed.size(), -1, scratch_.resource());
  for (std::size_t i = 0; i < floor.size(); ++i) floor_of[floor[i].observed] = static_cast<int>(i);

  Associations associations(scratch_.resource());
  expect(view, associations);
  associations.seen.resize(associations.expected.size());
  associations.used.resize(observed.size(), false);
  const AssociationResult association =
      vismem::associate(observed, associations.expected, params_.association, scratch_.resource());
  const auto assign = [&](const ImageAnalysis::Match& match) {
    const int i = floor_of[match.observed];
    if (i < 0) return false;
    const double distance = view.distanceTo(placed[i]);
    if (!fitsOnFloor(elements_[associations.index_of[match.predicted]], placed[i], distance)) return false;
    associations.seen[match.predicted].push_back(&floor[i]);
    associations.used[match.observed] = true;
    return true;
  };
  for (const auto& match : association.matches) {
    if (assign(match)) associations.matches.push_back(match);
  }
  for (const auto& support : association.supports) assign(support);
  return associations;
}

SegmentMemory::Associations SegmentMemory::associate(const View& view,
                                                     const std::vector<ImageSegment>& observed,
                                                     const std::vector<FloorSegment>& floor) const {
  Associations first = associatePlaced(view, observed, floor, floor);
  if (!isLegged()) return first;
  // The tilt of a walking body displaces segments by several pixels: unmatched ones would be added as
  // duplicates.
  const auto correction = updateMapFilter(first, view, nullptr);
  if (!correction) return first;
  View tilted_view = view;
  std::pmr::vector<FloorSegment> placed(floor.begin(), floor.end(), scratch_.resource());
  reproject(*correction, placed, tilted_view);
  return associatePlaced(tilted_view, observed, floor, placed);
}

void SegmentMemory::reproject(const Correction& correction, std::span<FloorSegment> floor, View& view) {
  CameraTilt change = correction.camera_tilt;
  change.head<2>() += correction.frame_tilt;
  const Pose3 T_odom_camera =
      toPose3(view.observation.T_odom_robot) * tilted(view.observation.T_robot_camera, change);
  const Eigen::Matrix3d R = T_odom_camera.linear() * view.T_odom_camera.linear().transpose();
  for (FloorSegment& segment : floor) {
    for (FloorEnd* end : {&segment.a, &segment.b})
      end->p = reprojectOnFloor(end->p, T_odom_camera.translation(), R);
  }
  view.T_odom_camera = T_odom_camera;
}

void SegmentMemory::correct(const Associations& associations, std::vector<FloorSegment>& floor, View& view) {
  if (!params_.estimation.enabled) return;
  if (const auto correction = updateMapFilter(associations, view, &map_filter_))
    applyCorrection(*correction, floor, view);
  for (FloorSegment& segment : floor) {
    const double far = std::max((segment.a.p - view.camera).norm(), (segment.b.p - view.camera).norm());
    if (far > kRangeSlack * params_.gates.max_range_m) {
      cutToRange(segment, view.camera, params_.gates.max_range_m);
    }
  }
}

void SegmentMemory::applyCorrection(const Correction& correction, std::vector<FloorSegment>& floor,
                                    View& view) {
  transformAll(correction.motion);
  std::pmr::vector<bool> in_filter(elements_.size(), false, scratch_.resource());
  for (const LineCorrection& line : map_filter_.lineCorrections()) {
    MemoryElement* const element = findElement(elements_, line.line);
    if (!element) continue;
    element->line.correct(line.reference, line.offset_m, line.turn_rad);
    element->line.know(line.reference, line.P, line.J);
    in_filter[element - elements_.data()] = true;
  }
  for (MemoryElement& element : elements_) {
    if (in_filter[&element - elements_.data()]) {
      element.line.tiltExtent(correction.camera_tilt);
    } else {
      element.line.applyTiltChange(correction.camera_tilt);
    }
    element.plane.applyTiltChange(correction.camera_tilt);
  }
  view.P_frame_tilt = correction.P_frame_tilt;
  // The segments of this image move, too.
  for (FloorSegment& segment : floor) {
    conditionOnFrameTilt(segment, correction.P_frame_tilt, params_.estimation.tilt_prior.per_frame_rad);
  }
  reproject(correction, floor, view);
}

}  // namespace vismem
