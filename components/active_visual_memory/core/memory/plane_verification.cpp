#include "active_visual_memory/core/memory/plane_verification.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr double kNotRadial = 0.2;   // least sine to the viewing ray that excludes a vertical edge
constexpr double kNoiseShare = 0.1;  // share of the variance of an end that is independent between views
constexpr double kAlignmentSigma_m = 0.003;    // error of the alignment, which does not grow with the way: ..
constexpr double kAlignmentSigma_rad = 0.004;  // .. of places and of the heading

/// Of a shift by the tilt of one image, which is another one in each.
double frameVariance(const TiltJacobianRow& d_tilt, const Eigen::Matrix2d& P_frame_tilt) {
  const Eigen::RowVector2d d = d_tilt.head<2>();
  return d * P_frame_tilt * d.transpose();
}

}  // namespace

void PlaneVerification::begin(const FloorLine& line, const PlaneView& view) {
  first_camera = view.camera;
  setAnchor(line, view);
}

void PlaneVerification::setAnchor(const FloorLine& line, const PlaneView& view) {
  parallax = ParallaxEstimate{};
  anchored = true;
  anchor_line = line;
  anchor_camera = view.camera;
}

void PlaneVerification::contradict() {
  if (stands) return;
  on_floor = anchored = false;
  parallax = ParallaxEstimate{};
}

double PlaneVerification::possibleShift(const PlaneView& view, const ParallaxEstimate::Params& params) const {
  if (on_floor) return 0.0;
  const double way = std::abs(anchor_line.normal().dot(view.camera - first_camera));
  const auto slope = parallax.slope(ParallaxEstimate::kOffset, view.P_tilt, params);
  return slope ? way * std::min(1.0, std::hypot(slope->value, std::sqrt(slope->variance))) : way;
}

void PlaneVerification::addOffset(const FloorSegment& observed, const PlaneView& view, double drift_m,
                                  const ParallaxEstimate::Params& params) {
  // A constant offset of the anchor cancels, an error of its direction does not.
  const Eigen::Vector2d n = anchor_line.normal();
  // A vertical edge turns about its foot: its far end shows most parallax.
  const bool b_is_far = (observed.b.p - view.camera).norm() > (observed.a.p - view.camera).norm();
  const Eigen::Vector2d at = not_vertical ? observed.odom().middle() : observed.end(b_is_far).p;
  const double t = anchor_line.tOf(at);
  const double f = (at - observed.a.p).norm() / std::max(1e-6, observed.odom().length());
  const TiltJacobianRow d_at = n.transpose() * ((1.0 - f) * observed.a.D + f * observed.b.D);
  const double variance =
      0.25 * kNoiseShare * n.dot((observed.a.P + observed.b.P) * n) + anchor_line.turnVariance(t);
  parallax.add(ParallaxEstimate::kOffset, n.dot(view.camera - anchor_camera), anchor_line.offsetOf(at),
               d_at - anchor_line.offsetTiltJacobian(t),
               variance + drift_m * drift_m + frameVariance(d_at, view.P_frame_tilt), params);
}

void PlaneVerification::addEnd(const FloorLine& line, const FloorSegment& observed, bool at_b,
                               const PlaneView& view, double drift_m, const ParallaxEstimate::Params& params,
                               const FloorLine::Params& line_params) {
  const ExtentEnd& known = line.end(at_b);
  const FloorEnd& seen = observed.end(at_b);
  if (seen.censored || known.censored) return;
  const Eigen::Vector2d u = anchor_line.along();
  const double variance = seen.varianceAlong(u);
  const auto channel = at_b ? ParallaxEstimate::kEndB : ParallaxEstimate::kEndA;
  // Only while it is the end of the anchor.
  const double off = line.tOf(seen.p) - known.t_m;
  if (std::abs(off) > endGate(known.variance_m2, variance, line_params)) {
    const bool outside = at_b ? off > 0.0 : off < 0.0;
    if (outside) parallax.forget(channel);  // the old end was not a true end
    return;
  }
  const TiltJacobianRow d_tilt = u.transpose() * seen.D;
  parallax.add(channel, u.dot(view.camera - anchor_camera), anchor_line.tOf(seen.p), d_tilt,
               kNoiseShare * variance + drift_m * drift_m + frameVariance(d_tilt, view.P_frame_tilt), params);
}

void PlaneVerification::observe(const FloorLine& line, const FloorSegment& observed, const PlaneView& view,
                                const ParallaxEstimate::Params& params,
                                const FloorLine::Params& line_params) {
  if (!anchored) setAnchor(line, view);
  if (baseline(view.camera) < params.min_step_m) {
    // Views from the place of the anchor improve it and have no parallax.
    anchor_line = line;
    parallax = ParallaxEstimate{};
  }
  const Eigen::Vector2d to_it = observed.odom().middle() - view.camera;
  const double drift_m = kAlignmentSigma_m + kAlignmentSigma_rad * to_it.norm();
  addOffset(observed, view, drift_m, params);
  for (const bool at_b : {false, true}) addEnd(line, observed, at_b, view, drift_m, params, line_params);
  // A vertical edge is projected onto a ray from the point below the camera.
  const Eigen::Vector2d seen_along = (observed.b.p - observed.a.p).normalized();
  if (std::abs(cross2(to_it.normalized(), seen_along)) > kNotRadial) not_vertical = true;
  const auto verdict = parallax.verdict(view.height_m, not_vertical, view.P_tilt, params);
  stands = verdict == ParallaxEstimate::Verdict::kOffFloor;
  if (verdict != ParallaxEstimate::Verdict::kUnknown) on_floor = !stands;
}

void PlaneVerification::transform(const PlanarIncrement& motion) {
  anchor_line.transform(motion);
  anchor_camera = motion.apply(anchor_camera);
  first_camera = motion.apply(first_camera);
}

void PlaneVerification::applyTiltChange(const CameraTilt& change) {
  anchor_line.applyTiltChange(change);
  parallax.applyTiltChange(change);
}

}  // namespace vismem
