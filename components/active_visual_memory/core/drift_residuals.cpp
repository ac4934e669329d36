#include "active_visual_memory/core/drift_residuals.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "active_visual_memory/core/floor_matching.h"
#include "common/geometry/angles.h"

namespace vismem {
double ownVariance(const Eigen::Vector2d& direction, const Eigen::Matrix2d& P, const FloorLean& D,
                   double pitch_sigma_rad) {
  return std::max(
      0.0, direction.dot(P * direction) -
               pitch_sigma_rad * pitch_sigma_rad * (direction.transpose() * D.rightCols<2>()).squaredNorm());
}

double offCourse(double direction_rad, double course_rad) {
  return 0.25 * wrapAngle(4.0 * (direction_rad - course_rad));
}

namespace {

/// @param jointly the line's own error and how it follows the lean are known to the filter.
void compare(const FloorLine& line, const FloorSegment& piece, const LeaningView& view, double slack_m,
             double noise, double end_doubt, double max_end_shift_m, bool jointly, auto across_line,
             auto along_line) {
  const Eigen::Vector2d n = line.normal();
  const Eigen::Vector2d u = line.along();
  const bool against = u.dot(piece.odom.b - piece.odom.a) < 0.0;
  const FloorSegment observed = against ? reversed(piece) : piece;
  const double slack = slack_m * slack_m;
  const double end_noise = noise * end_doubt * end_doubt;
  const auto variance = [&](const Eigen::Vector2d& direction, const Eigen::Matrix2d& P, const FloorLean& D) {
    return ownVariance(direction, P, D, observed.pitch_sigma_rad);
  };
  const auto add = [&](const Eigen::Vector2d& at, const Eigen::Matrix2d& P, const FloorLean& D, bool open,
                       const ExtentEnd& known) {
    const double t = line.tOf(at);
    LeanRow across = n.transpose() * view.derivativeAt(at - line.offsetOf(at) * n);
    const Eigen::RowVector2d sway = across.head<2>();
    double of_line = 0.0;
    if (!jointly) {
      across -= line.offsetLean(t);
      of_line = line.offsetVariance(t);
    }
    across_line(
        DriftResidual{at, n, line.offsetOf(at), noise * (variance(n, P, D) + of_line + slack), across, sway});
    const double gap = t - known.t_m;
    if (open || known.open || std::abs(gap) > max_end_shift_m) return;
    const LeanRow far = u.transpose() * view.derivativeAt(line.pointAt(known.t_m));
    along_line(DriftResidual{at, u, gap, end_noise * (variance(u, P, D) + known.variance_m2 + slack),
                             far - known.d_lean, far.head<2>()});
  };
  add(observed.odom.a, observed.P_a, observed.D_a, observed.open_a, line.endA());
  add(observed.odom.b, observed.P_b, observed.D_b, observed.open_b, line.endB());
}

}  // namespace

void addDriftResiduals(const FloorLine& line, const FloorSegment& piece, const LeaningView& view,
                       double slack_m, double noise, double end_doubt, double max_end_shift_m,
                       std::vector<DriftResidual>& residuals) {
  const auto add = [&](const DriftResidual& r) { residuals.push_back(r); };
  compare(line, piece, view, slack_m, noise, end_doubt, max_end_shift_m, false, add, add);
}

void addJointResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& piece,
                       const LeaningView& view, double slack_m, double noise, double end_doubt,
                       double max_end_shift_m, std::vector<JointResidual>& residuals) {
  compare(
      line, piece, view, slack_m, noise, end_doubt, max_end_shift_m, true,
      [&](const DriftResidual& r) {
        residuals.push_back({r, id});
      },
      [&](const DriftResidual& r) {
        residuals.push_back({r, 0});
      });
}

void Rectilinearity::add(double direction_rad, double length_m) {
  if (length_m < params_.least_m) return;
  const double course = offCourse(direction_rad, 0.0) / (0.5 * std::numbers::pi) + 0.5;  // 0..1
  const int bin = std::clamp(static_cast<int>(course * kBins), 0, kBins - 1);
  length_m_[bin] += length_m;
  sums_[bin] += length_m * Eigen::Vector2d(std::cos(4.0 * direction_rad), std::sin(4.0 * direction_rad));
  ++lines_[bin];
  all_m_ += length_m;
}

std::optional<double> Rectilinearity::course() const {
  const int reach = static_cast<int>(params_.together_rad / (0.5 * std::numbers::pi / kBins) + 0.5);
  double most_m = 0.0;
  std::optional<double> course;
  for (int middle = 0; middle < kBins; ++middle) {
    double length_m = 0.0;
    int lines = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int i = middle - reach; i <= middle + reach; ++i) {
      length_m += length_m_[(i + kBins) % kBins];
      lines += lines_[(i + kBins) % kBins];
      sum += sums_[(i + kBins) % kBins];
    }
    if (lines < params_.least_lines || length_m < params_.least_share * all_m_ || length_m <= most_m)
      continue;
    most_m = length_m;
    course = 0.25 * std::atan2(sum.y(), sum.x());
  }
  return course;
}

void addCourseResiduals(const std::vector<FloorSegment>& floor, const LeaningView& view, const Lean& about,
                        const CourseParams& params, const std::optional<double>& known_rad,
                        std::vector<DriftResidual>& residuals) {
  if (!(params.sigma_rad > 0.0)) return;
  const auto tells = [&](const FloorSegment& s) {
    const Eigen::Vector2d ray = (s.odom.middle() - view.camera.head<2>()).normalized();
    const Eigen::Vector2d along = s.odom.b - s.odom.a;
    const double length = along.norm();
    return length >= params.least_m &&
           std::abs(ray.x() * along.y() - ray.y() * along.x()) >= params.not_radial * length;
  };
  const auto leant = [&](const Eigen::Vector2d& p, const FloorLean& D) -> Eigen::Vector2d {
    return p + view.derivativeAt(p + 0.5 * D * about) * about;
  };
  // If it is not known: the direction that most of them, by length, have in common.
  std::optional<double> course = known_rad;
  double most = 0.0;
  for (const FloorSegment& candidate : floor) {
    if (known_rad || !tells(candidate)) continue;
    double votes = 0.0;
    for (const FloorSegment& other : floor) {
      if (&other == &candidate || !tells(other)) continue;
      const double off = offCourse(other.odom.direction(), candidate.odom.direction());
      if (std::abs(off) <= params.together_rad) votes += other.odom.length();
    }
    if (votes > most) most = votes, course = candidate.odom.direction();
  }
  if (!course) return;
  for (const FloorSegment& s : floor) {
    if (!tells(s)) continue;
    if (std::abs(offCourse(s.odom.direction(), *course)) > params.together_rad) continue;
    const Segment2 line{leant(s.odom.a, s.D_a), leant(s.odom.b, s.D_b)};
    const double length = line.length();
    const Eigen::Vector2d along = (line.b - line.a) / length;
    const Eigen::Vector2d n{-along.y(), along.x()};
    const double own =
        (ownVariance(n, s.P_a, s.D_a, s.pitch_sigma_rad) + ownVariance(n, s.P_b, s.D_b, s.pitch_sigma_rad)) /
        (length * length);
    const LeanRow d = n.transpose() * (view.derivativeAt(line.b) - view.derivativeAt(line.a)) / length;
    const double off = offCourse(line.direction(), *course) - d.dot(about);
    residuals.push_back({s.odom.middle(), Eigen::Vector2d::Zero(), off,
                         own + params.sigma_rad * params.sigma_rad, d, d.head<2>(), known_rad ? 0.0 : 1.0,
                         known_rad ? 1.0 : 0.0});
  }
}

std::optional<CourseDeviation> courseDeviation(const std::vector<FloorSegment>& floor,
                                               const LeaningView& view, const CourseParams& params,
                                               double course_rad, double sway_rad) {
  CourseParams wide = params;
  wide.together_rad = params.slipped_rad;
  std::vector<DriftResidual> residuals;
  Lean about = Lean::Zero();
  Eigen::Vector3d state = Eigen::Vector3d::Zero();  // sway, turn
  Eigen::Matrix3d information;
  for (int i = 0; i < 2; ++i) {
    residuals.clear();
    addCourseResiduals(floor, view, about, wide, course_rad, residuals);
    if (residuals.empty()) return std::nullopt;
    information = Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal();
    information /= sway_rad * sway_rad;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const DriftResidual& r : residuals) {
      const Eigen::Vector3d h{-r.d_sway.x(), -r.d_sway.y(), 1.0};
      information += h * h.transpose() / r.variance_m2;
      right += h * r.residual_m / r.variance_m2;
    }
    state = information.ldlt().solve(right);
    about.head<2>() = state.head<2>();
  }
  return CourseDeviation{state.z(), information.inverse()(2, 2)};
}

}  // namespace vismem
