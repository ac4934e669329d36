#include "active_visual_memory/core/ground/floor_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"

namespace vismem {

double endGate(double one, double other, const FloorLine::Params& params) {
  return std::max(params.end_gate_m, params.end_gate_sigmas * std::sqrt(one + other));
}

ExtentEnd fuseEnds(const ExtentEnd& known, const ExtentEnd& seen, double outward,
                   const FloorLine::Params& params) {
  const double further = outward * (seen.t_m - known.t_m);
  const double gate = endGate(known.variance_m2, seen.variance_m2, params);
  const bool well_known = !known.censored && known.views >= params.known_views;
  const bool may_extend =
      !known.split && (!well_known || seen.variance_m2 <= params.worse_view * known.best_m2);
  if (seen.censored) {
    // A censored end is a bound: it moves the extent only if it lies outside, beyond the noise of a true
    // end.
    const bool outside = known.censored ? further > 0.0 : further > gate && may_extend;
    return outside ? seen : known;
  }
  if (known.censored) return further > -gate ? seen : known;
  if (std::abs(further) > gate) return further > 0.0 && may_extend ? seen : known;
  ExtentEnd fused = known;
  const double noise = further > 0.0 ? params.end_outward_m : params.end_noise_m;
  const double known_variance = known.variance_m2 + noise * noise;
  const double gain = known_variance / (known_variance + seen.variance_m2);
  fused.t_m += gain * (seen.t_m - known.t_m);
  fused.d_tilt += gain * (seen.d_tilt - known.d_tilt);
  fused.variance_m2 = std::max((1.0 - gain) * known_variance, params.end_floor_m * params.end_floor_m);
  fused.best_m2 = std::min(known.best_m2, seen.best_m2);
  fused.views = known.views + seen.views;
  return fused;
}

bool areSplit(const FloorLine& one, const FloorLine& other) {
  const bool against = one.along().dot(other.along()) < 0.0;
  const Segment2 line = other.segment();
  const double low = one.tOf(against ? line.b : line.a);
  const double high = one.tOf(against ? line.a : line.b);
  const bool behind = low + high > one.endA().t_m + one.endB().t_m;
  const ExtentEnd& ends = behind ? one.endB() : one.endA();
  const ExtentEnd& begins = behind != against ? other.endA() : other.endB();
  if (!ends.split && !begins.split) return false;
  const double gap = behind ? low - ends.t_m : ends.t_m - high;
  return gap > -0.5 * std::min(one.length(), other.length());
}

FloorLine::FloorLine(const FloorSegment& segment, const Params& params) {
  const Segment2 odom = segment.odom();
  origin_ = odom.middle();
  turnTo(odom.direction());
  const Eigen::Vector2d n = normal();
  const double floor_variance = params.measure_floor_m * params.measure_floor_m;
  const double va = segment.a.varianceAlong(n) + floor_variance;
  const double vb = segment.b.varianceAlong(n) + floor_variance;
  // offset = (ya + yb) / 2, angle = (yb - ya) / length.
  const double length = odom.length();
  P_(0, 0) = 0.25 * (va + vb);
  P_(1, 1) = (va + vb) / (length * length);
  P_(0, 1) = P_(1, 0) = 0.5 * (vb - va) / length;
  J_.row(0) = 0.5 * n.transpose() * (segment.a.D + segment.b.D);
  J_.row(1) = n.transpose() * (segment.b.D - segment.a.D) / length;
  a_ = project(segment.a);
  b_ = project(segment.b);
  a_.t_m = -0.5 * length;
  b_.t_m = 0.5 * length;
  applyFloor(params);
}

ExtentEnd FloorLine::project(const FloorEnd& seen) const {
  const double variance = seen.varianceAlong(along());
  return {tOf(seen.p), variance, seen.censored, variance, 1, along().transpose() * seen.D, false};
}

FloorEnd FloorLine::floorEnd(bool at_b) const {
  const ExtentEnd& e = end(at_b);
  const Eigen::Vector2d u = along();
  const Eigen::Vector2d n = normal();
  return {pointAt(e.t_m), e.variance_m2 * u * u.transpose() + offsetVariance(e.t_m) * n * n.transpose(),
          u * e.d_tilt + n * offsetTiltJacobian(e.t_m), e.censored};
}

void FloorLine::turnTo(double direction_rad) {
  direction_rad_ = direction_rad;
  along_ = {std::cos(direction_rad), std::sin(direction_rad)};
}

Segment2 FloorLine::segment() const {
  return {pointAt(a_.t_m), pointAt(b_.t_m)};
}

double FloorLine::offsetVariance(double t) const {
  return P_(0, 0) + 2.0 * t * P_(0, 1) + t * t * P_(1, 1);
}

void FloorLine::transform(const PlanarIncrement& motion) {
  origin_ = motion.apply(origin_);
  direction_rad_ = wrapAngle(direction_rad_ + motion.turn_rad());
  along_ = motion.rotate(along_);
}

void FloorLine::applyTiltChange(const CameraTilt& change) {
  const Eigen::Vector2d moved = J_ * change;
  origin_ += moved.x() * normal();
  turnTo(wrapAngle(direction_rad_ + moved.y()));
  tiltExtent(change);
}

void FloorLine::drift(double offset_sigma_m, double angle_sigma_rad) {
  P_(0, 0) += offset_sigma_m * offset_sigma_m;
  P_(1, 1) += angle_sigma_rad * angle_sigma_rad;
  a_.variance_m2 += offset_sigma_m * offset_sigma_m;
  b_.variance_m2 += offset_sigma_m * offset_sigma_m;
}

double FloorLine::disagreement(const FloorSegment& observed, double slack_m,
                               const CameraTiltCovariance& P_tilt) const {
  const Eigen::Vector2d n = normal();
  const auto squaredDistance = [&](const FloorEnd& seen) {
    // Beyond the observed extent the error of the direction dominates: compared at the nearest observed
    // place.
    const double t = std::clamp(tOf(seen.p), a_.t_m, b_.t_m);
    const TiltJacobianRow d = n.transpose() * seen.D - offsetTiltJacobian(t);
    const double variance =
        offsetVariance(t) + seen.varianceAlong(n) + slack_m * slack_m + d * P_tilt * d.transpose();
    const double offset = offsetOf(seen.p);
    return offset * offset / variance;
  };
  return std::max(squaredDistance(observed.a), squaredDistance(observed.b));
}

void FloorLine::updateOffset(double t, double offset, double variance, const TiltJacobianRow& d_tilt) {
  const Eigen::Vector2d h{1.0, t};
  const Eigen::Vector2d Ph = P_ * h;
  const double s = h.dot(Ph) + variance;
  const Eigen::Vector2d gain = Ph / s;
  correction_ += gain * (offset - h.dot(correction_));
  J_ += gain * (d_tilt - h.transpose() * J_);
  P_ -= gain * Ph.transpose();
}

void FloorLine::applyCorrection() {
  origin_ += correction_.x() * normal();
  turnTo(wrapAngle(direction_rad_ + correction_.y()));
  correction_.setZero();
}

void FloorLine::applyFloor(const Params& params) {
  P_(0, 1) = P_(1, 0) = 0.5 * (P_(0, 1) + P_(1, 0));
  P_(0, 0) = std::max(P_(0, 0), params.offset_floor_m * params.offset_floor_m);
  P_(1, 1) = std::max(P_(1, 1), params.angle_floor_rad * params.angle_floor_rad);
  const double limit = 0.98 * std::sqrt(P_(0, 0) * P_(1, 1));
  P_(0, 1) = P_(1, 0) = std::clamp(P_(0, 1), -limit, limit);
}

void FloorLine::recentre() {
  // Away from the middle, offset and angle of a long line would be strongly correlated.
  const double s = 0.5 * (a_.t_m + b_.t_m);
  origin_ += s * along();
  a_.t_m -= s;
  b_.t_m -= s;
  const double p01 = P_(0, 1);
  P_(0, 0) += 2.0 * s * p01 + s * s * P_(1, 1);
  P_(0, 1) = P_(1, 0) = p01 + s * P_(1, 1);
  J_.row(0) += s * J_.row(1);
}

void FloorLine::fuse(const FloorSegment& observed, const Params& params) {
  fuseLine(observed, params);
  fuseExtent(observed, params);
}

void FloorLine::fuseLine(const FloorSegment& observed, const Params& params) {
  P_(0, 0) += params.offset_noise_m * params.offset_noise_m;
  P_(1, 1) += params.angle_noise_rad * params.angle_noise_rad;
  const Eigen::Vector2d n = normal();
  const double floor_variance = params.measure_floor_m * params.measure_floor_m;
  for (const FloorEnd* seen : {&observed.a, &observed.b}) {
    updateOffset(tOf(seen->p), offsetOf(seen->p), seen->varianceAlong(n) + floor_variance,
                 n.transpose() * seen->D);
  }
  applyCorrection();
}

void FloorLine::fuseExtent(const FloorSegment& observed, const Params& params) {
  a_ = fuseEnds(a_, project(observed.a), -1.0, params);
  b_ = fuseEnds(b_, project(observed.b), +1.0, params);
  recentre();
  applyFloor(params);
}

void FloorLine::correct(const Eigen::Vector2d& reference, double offset_m, double turn_rad) {
  correction_ = {offset_m - tOf(reference) * turn_rad, turn_rad};
  applyCorrection();
}

void FloorLine::know(const Eigen::Vector2d& reference, const Eigen::Matrix2d& P,
                     const Eigen::Matrix<double, 2, 4>& J) {
  Eigen::Matrix2d to_origin;
  to_origin << 1.0, -tOf(reference), 0.0, 1.0;
  P_ = to_origin * P * to_origin.transpose();
  J_ = to_origin * J;
}

void FloorLine::tiltExtent(const CameraTilt& change) {
  a_.t_m += a_.d_tilt.dot(change);
  b_.t_m += b_.d_tilt.dot(change);
  if (a_.t_m > b_.t_m) std::swap(a_, b_);
}

void FloorLine::replaceKeepingExtent(const FloorSegment& observed, const Params& params) {
  const FloorLine old = *this;
  *this = FloorLine(observed, params);
  const Segment2 before = old.segment();
  ExtentEnd old_a = old.a_;
  ExtentEnd old_b = old.b_;
  old_a.t_m = tOf(before.a);
  old_b.t_m = tOf(before.b);
  if (old_a.t_m < a_.t_m) a_ = old_a;
  if (old_b.t_m > b_.t_m) b_ = old_b;
  recentre();
  applyFloor(params);
}

void FloorLine::absorb(const FloorLine& other, const Params& params) {
  // The better known line is updated by the other, so the order is nearly irrelevant.
  if (other.P_(0, 0) < P_(0, 0)) {
    FloorLine better = other;
    better.fuse(asObservation(), params);
    *this = better;
  } else {
    fuse(other.asObservation(), params);
  }
}

void FloorLine::shorten(bool at_b, const ExtentEnd& end) {
  (at_b ? b_ : a_) = end;
  if (a_.t_m > b_.t_m) std::swap(a_, b_);
  recentre();
}

FloorSegment FloorLine::asObservation() const {
  FloorSegment segment;
  segment.a = floorEnd(false);
  segment.b = floorEnd(true);
  return segment;
}

}  // namespace vismem
