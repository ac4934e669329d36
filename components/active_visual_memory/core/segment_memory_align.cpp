// How an image meets what is remembered, and what that tells of drift and lean.
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/segment_memory_view.h"

namespace vismem {

SegmentMemory::Meeting SegmentMemory::meet(const View& view, const std::vector<ImageSegment>& observed,
                                           const std::vector<FloorSegment>& floor,
                                           const std::vector<FloorSegment>& placed) const {
  std::vector<int> floor_of(observed.size(), -1);
  for (std::size_t i = 0; i < floor.size(); ++i) floor_of[floor[i].observed] = static_cast<int>(i);

  Meeting meeting;
  meeting.expected = expect(view, meeting.index_of);
  meeting.seen.resize(meeting.expected.size());
  meeting.used.resize(observed.size(), false);
  const AssociationResult association = associate(observed, meeting.expected, params_.association);
  const auto assign = [&](const ImageAnalysis::Match& match) {
    const int i = floor_of[match.observed];
    if (i < 0) return false;
    const double distance = (placed[i].odom.middle() - view.camera).norm();
    if (!fitsOnFloor(elements_[meeting.index_of[match.predicted]], placed[i], distance)) return false;
    meeting.seen[match.predicted].push_back(&floor[i]);
    meeting.used[match.observed] = true;
    return true;
  };
  for (const auto& match : association.matches) {
    if (assign(match)) meeting.matches.push_back(match);
  }
  for (const auto& support : association.supports) assign(support);
  return meeting;
}

SegmentMemory::Meeting SegmentMemory::meetSwaying(const View& view, const std::vector<ImageSegment>& observed,
                                                  const std::vector<FloorSegment>& floor) const {
  const Meeting first = meet(view, observed, floor, floor);
  std::optional<Correction> correction;
  if (joint()) {
    correction = tellJointly(first, view, nullptr);
  } else {
    DriftAlignment trial = drift_;
    correction = tellDrift(first, floor, view, trial);
  }
  if (!correction) return first;
  View swayed = view;
  std::vector<FloorSegment> placed = floor;
  placeAnew(*correction, placed, swayed);
  return meet(swayed, observed, floor, placed);
}

std::optional<Correction> SegmentMemory::tellDrift(const Meeting& meeting,
                                                   const std::vector<FloorSegment>& floor, const View& view,
                                                   DriftAlignment& drift) const {
  std::vector<DriftResidual> residuals;
  const LeaningView leaning(view.T_odom_camera, view.observation.T_odom_robot.theta);
  const bool anything_rests =
      std::any_of(elements_.begin(), elements_.end(), [](const MemoryElement& e) { return e.on_floor; });
  for (std::size_t p = 0; p < meeting.seen.size(); ++p) {
    const MemoryElement& element = elements_[meeting.index_of[p]];
    if (onTrial(element)) continue;
    // What is seen not to rest on the floor while the camera moves stands up, or moves along; what does not
    // prove to may do so, too.
    if (element.stands) continue;
    const double moved = (view.camera - element.anchor_camera).norm();
    // What came lately, while the robot drives, may be another robot that drives ahead: it would drag all
    // along. As long as nothing is sure to rest, there is nothing else to go by.
    if (anything_rests && !element.on_floor && moved > params_.parallax.min_step_m &&
        isNew(element, view.observation.frame.stamp_us)) {
      continue;
    }
    const double doubt = element.on_floor || moved < params_.parallax.min_step_m ? 1.0 : params_.align_doubt;
    const double noise = std::pow(params_.align_noise * doubt, 2);
    for (const FloorSegment* piece : meeting.seen[p]) {
      const double distance = (piece->odom.middle() - view.camera).norm();
      const double slack = params_.slack_m + params_.slack_share * distance;
      addDriftResiduals(element.line, *piece, leaning, slack, noise, params_.align_end_doubt,
                        params_.max_end_shift_m, residuals);
      // A line that is seen all the time follows what it is told. What the lean does on the way since it was
      // first seen shows against its place then; once for each step of the camera, however many images show
      // it.
      const double step = travel_m_ - element.seen_travel_m;
      if (step <= 0.0 || moved < params_.parallax.min_step_m || moved > params_.max_anchor_travel_m) continue;
      const double aligned = params_.aligned_m + params_.aligned_rad * distance;
      const double often = std::max(1.0, params_.parallax.min_step_m / step);
      addDriftResiduals(element.anchor_line, *piece, leaning, std::hypot(slack, aligned), noise * often,
                        params_.align_end_doubt, params_.max_end_shift_m, residuals);
    }
  }
  const Eigen::Vector2d robot = view.observation.T_odom_robot.position();
  const std::size_t matched = residuals.size();
  const auto course = params_.lean.enabled() ? courseOfAll() : std::nullopt;
  if (course) {
    const auto known = params_.compass ? course : std::nullopt;
    addCourseResiduals(floor, leaning, Lean::Zero(), params_.course, known, residuals);
    if (residuals.size() > matched) {
      // Once more, about where the first look at this image puts its lean.
      DriftAlignment trial = drift;
      Lean about = Lean::Zero();
      if (const auto first = trial.solve(robot, residuals, params_.alignment)) {
        about = first->lean;
        about.head<2>() += first->sway;
      }
      residuals.resize(matched);
      addCourseResiduals(floor, leaning, about, params_.course, known, residuals);
    }
  }
  return drift.solve(robot, residuals, params_.alignment);
}

void SegmentMemory::placeAnew(const Correction& correction, std::vector<FloorSegment>& floor, View& view) {
  Lean change = correction.lean;
  change.head<2>() += correction.sway;
  const Pose3 T_odom_camera =
      toPose3(view.observation.T_odom_robot) * leaned(view.observation.T_robot_camera, change);
  const Eigen::Matrix3d R = T_odom_camera.linear() * view.T_odom_camera.linear().transpose();
  for (FloorSegment& segment : floor) {
    segment.odom.a = turnedOnFloor(segment.odom.a, T_odom_camera.translation(), R);
    segment.odom.b = turnedOnFloor(segment.odom.b, T_odom_camera.translation(), R);
  }
  view.T_odom_camera = T_odom_camera;
}

void SegmentMemory::alignTo(const Meeting& meeting, std::vector<FloorSegment>& floor, View& view) {
  const auto correction =
      joint() ? tellJointly(meeting, view, &joint_) : tellDrift(meeting, floor, view, drift_);
  if (!correction) return;
  moveAll(correction->motion);
  if (joint()) followLines();
  for (MemoryElement& element : elements_) {
    if (joint() && joint_.knows(element.value.id)) {
      element.line.leanExtent(correction->lean);
    } else {
      element.line.lean(correction->lean);
    }
    element.anchor_line.lean(correction->lean);
    element.parallax.lean(correction->lean);
  }
  // What this image shows lies elsewhere, too. What it was compared with has errors that many lines share,
  // and that do not average out.
  const double sway = params_.lean.sway_rad;
  const double found = correction->P_sway.diagonal().maxCoeff();
  const double doubt = sways() && !joint() ? params_.sway_doubt * params_.sway_doubt : 1.0;
  const Eigen::Matrix2d P_sway =
      (doubt * found <= sway * sway || !(found > 0.0) ? doubt : sway * sway / found) * correction->P_sway;
  for (FloorSegment& segment : floor) knowSway(segment, P_sway, params_.lean.sway_rad);
  placeAnew(*correction, floor, view);
}

}  // namespace vismem
