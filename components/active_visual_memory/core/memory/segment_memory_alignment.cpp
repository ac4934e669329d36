// SegmentMemory: association of an image, update of the filters, correction of the memory.
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/memory/segment_memory_view.h"

namespace vismem {

SegmentMemory::Associations SegmentMemory::associate(const View& view,
                                                     const std::vector<ImageSegment>& observed,
                                                     const std::vector<FloorSegment>& floor,
                                                     const std::vector<FloorSegment>& placed) const {
  std::vector<int> floor_of(observed.size(), -1);
  for (std::size_t i = 0; i < floor.size(); ++i) floor_of[floor[i].observed] = static_cast<int>(i);

  Associations associations;
  associations.expected = expect(view, associations.index_of);
  associations.seen.resize(associations.expected.size());
  associations.used.resize(observed.size(), false);
  const AssociationResult association =
      vismem::associate(observed, associations.expected, params_.association);
  const auto assign = [&](const ImageAnalysis::Match& match) {
    const int i = floor_of[match.observed];
    if (i < 0) return false;
    const double distance = (placed[i].odom.middle() - view.camera).norm();
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

SegmentMemory::Associations SegmentMemory::associateIterated(const View& view,
                                                             const std::vector<ImageSegment>& observed,
                                                             const std::vector<FloorSegment>& floor) const {
  const Associations first = associate(view, observed, floor, floor);
  std::optional<Correction> correction;
  if (usesMapFilter()) {
    correction = updateMapFilter(first, view, nullptr);
  } else {
    DriftFilter trial = drift_filter_;
    correction = updateDriftFilter(first, floor, view, trial);
  }
  if (!correction) return first;
  View tilted_view = view;
  std::vector<FloorSegment> placed = floor;
  reproject(*correction, placed, tilted_view);
  return associate(tilted_view, observed, floor, placed);
}

std::optional<Correction> SegmentMemory::updateDriftFilter(const Associations& associations,
                                                           const std::vector<FloorSegment>& floor,
                                                           const View& view, DriftFilter& drift) const {
  std::vector<DriftResidual> residuals;
  const TiltView view_tilt(view.T_odom_camera, view.observation.T_odom_robot.theta);
  const bool anything_rests =
      std::any_of(elements_.begin(), elements_.end(), [](const MemoryElement& e) { return e.on_floor; });
  for (std::size_t p = 0; p < associations.seen.size(); ++p) {
    const MemoryElement& element = elements_[associations.index_of[p]];
    if (isTentative(element)) continue;
    // Elements off the floor, or possibly so, do not measure the drift.
    if (element.stands) continue;
    const double moved = (view.camera - element.anchor_camera).norm();
    // A new element may be another robot that drives ahead and would drag the memory along. Without any
    // element known to rest there is no better evidence.
    if (anything_rests && !element.on_floor && moved > params_.parallax.min_step_m &&
        isNew(element, view.observation.frame.stamp_us)) {
      continue;
    }
    const double inflation =
        element.on_floor || moved < params_.parallax.min_step_m ? 1.0 : params_.unconfirmed_inflation;
    const double noise = std::pow(params_.correlation_inflation * inflation, 2);
    for (const FloorSegment* piece : associations.seen[p]) {
      const double distance = (piece->odom.middle() - view.camera).norm();
      const double slack = params_.slack_m + params_.slack_share * distance;
      addDriftResiduals(element.line, *piece, view_tilt, slack, noise, params_.end_inflation,
                        params_.max_end_shift_m, residuals);
      // A line in view follows every update, so a tilt shows against its place at first sight only; counted
      // once per step of the camera.
      const double step = travel_m_ - element.seen_travel_m;
      if (step <= 0.0 || moved < params_.parallax.min_step_m || moved > params_.max_anchor_travel_m) continue;
      const double alignment_sigma = params_.alignment_sigma_m + params_.alignment_sigma_rad * distance;
      const double often = std::max(1.0, params_.parallax.min_step_m / step);
      addDriftResiduals(element.anchor_line, *piece, view_tilt, std::hypot(slack, alignment_sigma),
                        noise * often, params_.end_inflation, params_.max_end_shift_m, residuals);
    }
  }
  const Eigen::Vector2d robot = view.observation.T_odom_robot.position();
  const std::size_t matched = residuals.size();
  const auto direction = params_.tilt_prior.enabled() ? dominantDirection() : std::nullopt;
  if (direction) {
    const auto known = params_.use_dominant_direction ? direction : std::nullopt;
    addDirectionResiduals(floor, view_tilt, CameraTilt::Zero(), params_.dominant_direction, known, residuals);
    if (residuals.size() > matched) {
      // Second linearization, about the tilt of the first one.
      DriftFilter trial = drift;
      CameraTilt about = CameraTilt::Zero();
      if (const auto first = trial.update(robot, residuals, params_.alignment)) {
        about = first->camera_tilt;
        about.head<2>() += first->frame_tilt;
      }
      residuals.resize(matched);
      addDirectionResiduals(floor, view_tilt, about, params_.dominant_direction, known, residuals);
    }
  }
  return drift.update(robot, residuals, params_.alignment);
}

void SegmentMemory::reproject(const Correction& correction, std::vector<FloorSegment>& floor, View& view) {
  CameraTilt change = correction.camera_tilt;
  change.head<2>() += correction.frame_tilt;
  const Pose3 T_odom_camera =
      toPose3(view.observation.T_odom_robot) * tilted(view.observation.T_robot_camera, change);
  const Eigen::Matrix3d R = T_odom_camera.linear() * view.T_odom_camera.linear().transpose();
  for (FloorSegment& segment : floor) {
    segment.odom.a = reprojectOnFloor(segment.odom.a, T_odom_camera.translation(), R);
    segment.odom.b = reprojectOnFloor(segment.odom.b, T_odom_camera.translation(), R);
  }
  view.T_odom_camera = T_odom_camera;
}

void SegmentMemory::applyCorrection(const Associations& associations, std::vector<FloorSegment>& floor,
                                    View& view) {
  const auto correction = usesMapFilter() ? updateMapFilter(associations, view, &map_filter_)
                                          : updateDriftFilter(associations, floor, view, drift_filter_);
  if (!correction) return;
  transformAll(correction->motion);
  if (usesMapFilter()) applyLineCorrections();
  for (MemoryElement& element : elements_) {
    if (usesMapFilter() && map_filter_.contains(element.value.id)) {
      element.line.tiltExtent(correction->camera_tilt);
    } else {
      element.line.applyTiltChange(correction->camera_tilt);
    }
    element.anchor_line.applyTiltChange(correction->camera_tilt);
    element.parallax.applyTiltChange(correction->camera_tilt);
  }
  // The segments of this image move, too. The errors of the lines compared with are common to many of them
  // and do not average out.
  const double frame_tilt = params_.tilt_prior.per_frame_rad;
  const double found = correction->P_frame_tilt.diagonal().maxCoeff();
  const double inflation =
      isLegged() && !usesMapFilter() ? params_.per_frame_inflation * params_.per_frame_inflation : 1.0;
  const Eigen::Matrix2d P_frame_tilt =
      (inflation * found <= frame_tilt * frame_tilt || !(found > 0.0) ? inflation
                                                                      : frame_tilt * frame_tilt / found) *
      correction->P_frame_tilt;
  for (FloorSegment& segment : floor)
    conditionOnFrameTilt(segment, P_frame_tilt, params_.tilt_prior.per_frame_rad);
  reproject(*correction, floor, view);
}

}  // namespace vismem
