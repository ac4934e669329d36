// How a swaying body's memory is told of drift, lean and lines in one filter.
#include <algorithm>
#include <cmath>

#include "active_visual_memory/core/segment_memory_view.h"

namespace vismem {

JointAlignment::Params SegmentMemory::jointParams() const {
  JointAlignment::Params params = params_.jointly;
  params.drift = params_.alignment;
  params.together_rad = params_.course.together_rad;
  return params;
}

std::optional<Correction> SegmentMemory::tellJointly(const Meeting& meeting, const View& view,
                                                     JointAlignment* joint) const {
  std::vector<JointResidual> residuals;
  const LeaningView leaning(view.T_odom_camera, view.observation.T_odom_robot.theta);
  for (std::size_t p = 0; p < meeting.seen.size(); ++p) {
    const MemoryElement& element = elements_[meeting.index_of[p]];
    if (!joint_.knows(element.value.id)) continue;
    const double moved = (view.camera - element.anchor_camera).norm();
    const double doubt = element.on_floor || moved < params_.parallax.min_step_m ? 1.0 : params_.align_doubt;
    const double noise = std::pow(params_.align_noise * doubt, 2);
    for (const FloorSegment* piece : meeting.seen[p]) {
      const double distance = (piece->odom.middle() - view.camera).norm();
      addJointResiduals(element.value.id, element.line, *piece, leaning,
                        params_.slack_m + params_.slack_share * distance, noise, params_.align_end_doubt,
                        params_.max_end_shift_m, residuals);
    }
  }
  const auto course = params_.compass ? courseOfAll() : std::nullopt;
  std::vector<LineDirection> directions;
  for (const MemoryElement& element : elements_) {
    if (!course || onTrial(element) || element.stands || !element.not_vertical) continue;
    if (element.line.length() < params_.course.least_m) continue;
    directions.push_back({element.value.id, element.line.direction()});
  }
  const Eigen::Vector2d robot = view.observation.T_odom_robot.position();
  return joint ? joint->solve(robot, residuals, course, directions, jointParams())
               : joint_.look(robot, residuals, course, directions, jointParams());
}

void SegmentMemory::followSlip(const View& view, const std::vector<FloorSegment>& floor) {
  if (!joint_.course()) return;
  const LeaningView leaning(view.T_odom_camera, view.observation.T_odom_robot.theta);
  const auto deviation =
      courseDeviation(floor, leaning, params_.course, *joint_.course(), params_.lean.sway_rad);
  if (!deviation) return;
  const StampUs stamp_us = view.observation.frame.stamp_us;
  const auto slip = slips_.add(stamp_us, deviation->turn_rad, deviation->variance, params_.slip);
  if (!slip) return;
  // What was found since then was put where the slip has it.
  std::erase_if(elements_, [&](const MemoryElement& e) { return e.value.first_seen_us >= slip->since_us; });
  forgetLines();
  moveAll(joint_.slip(view.observation.T_odom_robot.position(), slip->turn_rad, slip->sigma_rad));
  publishAll();
}

void SegmentMemory::forgetLines() {
  // What stands up or moves by itself tells nothing.
  joint_.keepIf([&](std::uint64_t id) {
    return std::any_of(elements_.begin(), elements_.end(),
                       [id](const MemoryElement& e) { return e.value.id == id && !e.stands; });
  });
}

void SegmentMemory::join(MemoryElement& element, const MemoryElement& other) {
  // The better known line is the one that is corrected.
  if (joint() && other.line.offsetVariance(0.0) < element.line.offsetVariance(0.0)) {
    joint_.rename(other.value.id, element.value.id);
  }
  absorb(element, other, params_.line);
}

void SegmentMemory::followLines() {
  for (const LineCorrection& correction : joint_.lines()) {
    for (MemoryElement& element : elements_) {
      if (element.value.id != correction.line) continue;
      element.line.correct(correction.reference, correction.offset_m, correction.turn_rad);
      element.line.know(correction.reference, correction.P, correction.J);
      break;
    }
  }
}

}  // namespace vismem
