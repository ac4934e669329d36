#include "active_visual_memory/core/ground/floor_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

double varianceAlong(const Eigen::Matrix2d& P, const Eigen::Vector2d& direction) {
  return direction.dot(P * direction);
}

}  // namespace

ExtentEnd fuseEnds(const ExtentEnd& known, const ExtentEnd& seen, double outward,
                   const FloorLine::Params& params) {
  const double further = outward * (seen.t_m - known.t_m);
  const double gate =
      std::max(params.end_gate_m, params.end_gate_sigmas * std::sqrt(known.variance_m2 + seen.variance_m2));
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
  origin_ = segment.odom.middle();
  turnTo(segment.odom.direction());
  const double half = 0.5 * segment.odom.length();
  const Eigen::Vector2d n = normal();
  const double floor_variance = params.measure_floor_m * params.measure_floor_m;
  const double va = varianceAlong(segment.P_a, n) + floor_variance;
  const double vb = varianceAlong(segment.P_b, n) + floor_variance;
  // offset = (ya + yb) / 2, angle = (yb - ya) / length.
  const double length = 2.0 * half;
  P_(0, 0) = 0.25 * (va + vb);
  P_(1, 1) = (va + vb) / (length * length);
  P_(0, 1) = P_(1, 0) = 0.5 * (vb - va) / length;
  J_.row(0) = 0.5 * n.transpose() * (segment.D_a + segment.D_b);
  J_.row(1) = n.transpose() * (segment.D_b - segment.D_a) / length;
  a_ = endAt(-half, segment.P_a, segment.D_a, segment.censored_a);
  b_ = endAt(half, segment.P_b, segment.D_b, segment.censored_b);
  applyFloor(params);
}

ExtentEnd FloorLine::endAt(double t, const Eigen::Matrix2d& P, const TiltJacobian& D, bool censored) const {
  const double variance = varianceAlong(P, along());
  return {t, variance, censored, variance, 1, along().transpose() * D, false};
}

TiltJacobian FloorLine::tiltJacobianOf(const ExtentEnd& end) const {
  return along() * end.d_tilt + normal() * offsetTiltJacobian(end.t_m);
}

void FloorLine::turnTo(double direction_rad) {
  direction_rad_ = direction_rad;
  along_ = {std::cos(direction_rad), std::sin(direction_rad)};
}

Segment2 FloorLine::segment() const {
  return {origin_ + a_.t_m * along(), origin_ + b_.t_m * along()};
}

double FloorLine::offsetVariance(double t) const {
  return P_(0, 0) + 2.0 * t * P_(0, 1) + t * t * P_(1, 1);
}

Eigen::Matrix2d FloorLine::covarianceAt(const ExtentEnd& end) const {
  const Eigen::Vector2d u = along();
  const Eigen::Vector2d n = normal();
  return end.variance_m2 * u * u.transpose() + offsetVariance(end.t_m) * n * n.transpose();
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
  const auto one = [&](const Eigen::Vector2d& p, const Eigen::Matrix2d& P, const TiltJacobian& D) {
    // Beyond the observed extent the error of the direction dominates: compared at the nearest observed
    // place.
    const double t = std::clamp(tOf(p), a_.t_m, b_.t_m);
    const TiltJacobianRow d = n.transpose() * D - offsetTiltJacobian(t);
    const double variance =
        offsetVariance(t) + varianceAlong(P, n) + slack_m * slack_m + d * P_tilt * d.transpose();
    const double offset = offsetOf(p);
    return offset * offset / variance;
  };
  return std::max(one(observed.odom.a, observed.P_a, observed.D_a),
                  one(observed.odom.b, observed.P_b, observed.D_b));
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
  const double ya = offsetOf(observed.odom.a);
  const double yb = offsetOf(observed.odom.b);
  const double ta = tOf(observed.odom.a);
  const double tb = tOf(observed.odom.b);
  updateOffset(ta, ya, varianceAlong(observed.P_a, n) + floor_variance, n.transpose() * observed.D_a);
  updateOffset(tb, yb, varianceAlong(observed.P_b, n) + floor_variance, n.transpose() * observed.D_b);
  applyCorrection();
}

void FloorLine::fuseExtent(const FloorSegment& observed, const Params& params) {
  const double ta = tOf(observed.odom.a);
  const double tb = tOf(observed.odom.b);
  a_ = fuseEnds(a_, endAt(ta, observed.P_a, observed.D_a, observed.censored_a), -1.0, params);
  b_ = fuseEnds(b_, endAt(tb, observed.P_b, observed.D_b, observed.censored_b), +1.0, params);
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
  segment.odom = this->segment();
  segment.P_a = covarianceA();
  segment.P_b = covarianceB();
  segment.D_a = tiltJacobianA();
  segment.D_b = tiltJacobianB();
  segment.censored_a = a_.censored;
  segment.censored_b = b_.censored;
  return segment;
}

}  // namespace vismem
