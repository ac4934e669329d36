#include "common/vision/line_runs.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace vismem {
namespace {

constexpr int kRingOverlap = 16;      // points of a ring that come again at its end
constexpr double kReachShare = 0.75;  // of the line tolerance: points that turn at a corner
constexpr double kSolveGrowth = 1.4;  // the line follows its points when there are this much more of them

}  // namespace

/// Total least squares line from running sums, about an origin near the points for precision.
class LineRunFinder::Fit {
 public:
  void reset(double x0, double y0) {
    x0_ = x0;
    y0_ = y0;
    n_ = sx_ = sy_ = sxx_ = sxy_ = syy_ = 0.0;
  }
  void add(double px, double py) {
    const double x = px - x0_;
    const double y = py - y0_;
    n_ += 1.0;
    sx_ += x;
    sy_ += y;
    sxx_ += x * x;
    sxy_ += x * y;
    syy_ += y * y;
  }
  void remove(double px, double py) {
    const double x = px - x0_;
    const double y = py - y0_;
    n_ -= 1.0;
    sx_ -= x;
    sy_ -= y;
    sxx_ -= x * x;
    sxy_ -= x * y;
    syy_ -= y * y;
  }
  /// Whether the points' variance about their line is at most `limit`: without a square root.
  bool within(double limit) const {
    const double scale = 1.0 / n_;
    const double mx = sx_ * scale;
    const double my = sy_ * scale;
    const double xx = sxx_ * scale - mx * mx - limit;
    const double xy = sxy_ * scale - mx * my;
    const double yy = syy_ * scale - my * my - limit;
    // The smaller eigenvalue is under the limit, unless both of the shifted matrix are positive.
    return xx + yy <= 0.0 || xx * yy <= xy * xy;
  }
  void solve() {
    const double scale = 1.0 / n_;
    mx_ = sx_ * scale;
    my_ = sy_ * scale;
    const double xx = sxx_ * scale - mx_ * mx_;
    const double xy = sxy_ * scale - mx_ * my_;
    const double yy = syy_ * scale - my_ * my_;
    // Half-angle of (xx - yy, 2 xy) without trigonometry.
    const double c = xx - yy;
    const double s = 2.0 * xy;
    const double r = std::sqrt(c * c + s * s);
    const double cos_twice = r > 0.0 ? c / r : 1.0;
    dx_ = std::sqrt(std::max(0.0, 0.5 * (1.0 + cos_twice)));
    dy_ = std::sqrt(std::max(0.0, 0.5 * (1.0 - cos_twice)));
    if (s < 0.0) dy_ = -dy_;
    variance_ = std::max(0.0, 0.5 * (xx + yy - r));
    offset_ = (x0_ + mx_) * dy_ - (y0_ + my_) * dx_;
    along_ = (x0_ + mx_) * dx_ + (y0_ + my_) * dy_;
  }
  double offset(double x, double y) const { return std::abs(x * dy_ - y * dx_ - offset_); }
  double along(double x, double y) const { return x * dx_ + y * dy_ - along_; }
  Eigen::Vector2d point(double along) const { return {x0_ + mx_ + along * dx_, y0_ + my_ + along * dy_}; }
  double variance() const { return variance_; }
  double count() const { return n_; }
  double dx() const { return dx_; }
  double dy() const { return dy_; }

 private:
  double x0_ = 0.0, y0_ = 0.0;
  double n_ = 0.0, sx_ = 0.0, sy_ = 0.0, sxx_ = 0.0, sxy_ = 0.0, syy_ = 0.0;
  double mx_ = 0.0, my_ = 0.0, dx_ = 1.0, dy_ = 0.0, variance_ = 0.0;
  double offset_ = 0.0, along_ = 0.0;
};

void LineRunFinder::find(const EdgePointFinder& edges, std::vector<LineRun>& runs) {
  runs.clear();
  const int count = edges.count();
  const std::int32_t* next = edges.next();
  const std::uint8_t* has_previous = edges.hasPrevious();
  const std::size_t room = static_cast<std::size_t>(edges.capacity()) + kRingOverlap;
  used_.reserve(room);
  order_.reserve(room);
  on_line_.reserve(room);
  for (Room<float>* values : {&x_, &y_, &gx_, &gy_, &agreement_}) values->reserve(room);
  std::memset(used_.data(), 0, count);
  for (std::int32_t i = 0; i < count; ++i) {
    if (has_previous[i] != 0) continue;
    const int length = follow(next, i, false);
    if (length < params_.first_fit_points) continue;
    gather(edges.points(), length);
    split(length, runs);
  }
  // What is left are rings.
  for (std::int32_t i = 0; i < count; ++i) {
    if (used_[i] != 0) continue;
    const int length = follow(next, i, true);
    gather(edges.points(), length);
    split(length, runs);
  }
}

/// Lists a chain in order_. A ring begins anywhere on a side: going on over its beginning shows that side
/// whole.
int LineRunFinder::follow(const std::int32_t* next, std::int32_t first, bool ring) {
  // Members are read before: the compiler must take a write of bytes for one to any of them.
  std::int32_t* order = order_.data();
  std::uint8_t* used = used_.data();
  int length = 0;
  std::int32_t i = first;
  do {
    order[length++] = i;
    used[i] = 1;
    const int step = next[i];
    if (step == 0) return length;
    i += step;
  } while (!ring || i != first);
  if (length >= 2 * kRingOverlap) {
    std::copy_n(order, kRingOverlap, order + length);
    length += kRingOverlap;
  }
  return length;
}

void LineRunFinder::gather(const EdgePoint* points, int count) {
  const auto limit = static_cast<float>(params_.alignment_cos * params_.alignment_cos);
  const std::int32_t* order = order_.data();
  float* x = x_.data();
  float* y = y_.data();
  float* gx = gx_.data();
  float* gy = gy_.data();
  float* agreement = agreement_.data();
  for (int k = 0; k < count; ++k) {
    const EdgePoint& p = points[order[k]];
    x[k] = p.x;
    y[k] = p.y;
    gx[k] = static_cast<float>(p.gx);
    gy[k] = static_cast<float>(p.gy);
    agreement[k] = limit * static_cast<float>(p.squared);
  }
}

void LineRunFinder::split(int count, std::vector<LineRun>& runs) {
  const int window = params_.first_fit_points;
  const double first_variance = params_.first_fit_rms_px * params_.first_fit_rms_px;
  int free_from = 0;  // points before it belong to an earlier run; runs share the point between them
  int i = 0;
  Fit fit;
  bool fresh = true;
  while (i + window <= count) {
    if (fresh) {
      fit.reset(x_[i], y_[i]);
      for (int k = i; k < i + window; ++k) fit.add(x_[k], y_[k]);
      fresh = false;
    }
    if (!fit.within(first_variance)) {
      if (i + window < count) {
        fit.remove(x_[i], y_[i]);
        fit.add(x_[i + window], y_[i + window]);
      }
      ++i;
      continue;
    }
    fit.solve();
    std::memset(on_line_.data() + i, 1, window);
    const int last = extend(fit, i + window, count, 1);
    const int first = extend(fit, i - 1, free_from - 1, -1);
    emit(fit, first, last, runs);
    free_from = last;
    i = last;
    fresh = true;
  }
}

/// Adds points from `from` towards `stop` (excluded) while they lie on the line; a few strays are passed
/// over.
/// @return the last point on the line, or the one before `from` if none.
int LineRunFinder::extend(Fit& wanted, int from, int stop, int step) {
  // A copy, and members read before: the compiler must take a write of bytes for one to any of them.
  Fit fit = wanted;
  const float* x = x_.data();
  const float* y = y_.data();
  std::uint8_t* on_line = on_line_.data();
  const double tolerance_px = params_.line_tolerance_px;
  const int maximum_strays = params_.maximum_strays;
  int last = from - step;
  int strays = 0;
  double solve_at = kSolveGrowth * fit.count();
  bool stale = false;
  for (int k = from; k != stop; k += step) {
    double offset = fit.offset(x[k], y[k]);
    if (offset > tolerance_px && stale) {
      fit.solve();
      stale = false;
      offset = fit.offset(x[k], y[k]);
    }
    if (offset <= tolerance_px) {
      on_line[k] = 1;
      fit.add(x[k], y[k]);
      stale = true;
      if (fit.count() >= solve_at) {
        fit.solve();
        stale = false;
        solve_at = kSolveGrowth * fit.count();
      }
      last = k;
      strays = 0;
    } else {
      on_line[k] = 0;
      if (++strays > maximum_strays) break;
    }
  }
  if (stale) fit.solve();
  wanted = fit;
  return last;
}

void LineRunFinder::emit(Fit& fit, int first, int last, std::vector<LineRun>& runs) {
  // Chains run with the bright side on the left, so first -> last keeps that.
  const double sense = fit.along(x_[last], y_[last]) >= fit.along(x_[first], y_[first]) ? 1.0 : -1.0;
  // Round a corner the gradient turns before the points leave the line: those would bend the fit.
  int low = first;
  int high = last;
  while (first < last && !agrees(fit, first, sense)) ++first;
  while (last > first && !agrees(fit, last, sense)) --last;
  if (last - first + 1 < params_.first_fit_points) return;
  // Enough points whose own gradient agrees with the line: what chains of noise lack.
  const auto nx = static_cast<float>(sense * fit.dy());
  const auto ny = static_cast<float>(-sense * fit.dx());
  const float* gx = gx_.data();
  const float* gy = gy_.data();
  const float* agreement = agreement_.data();
  int agreeing = 0;
  for (int k = first; k <= last; ++k) {
    const float dot = nx * gx[k] + ny * gy[k];
    agreeing += static_cast<int>(dot >= 0.0F) & static_cast<int>(dot * dot >= agreement[k]);
  }
  if (agreeing < params_.alignment_share * (last - first + 1)) return;
  if (low != first || high != last) {
    for (int k = low; k < first; ++k) {
      if (on_line_[k] != 0) fit.remove(x_[k], y_[k]);
    }
    for (int k = high; k > last; --k) {
      if (on_line_[k] != 0) fit.remove(x_[k], y_[k]);
    }
    fit.solve();
  }
  if (fit.variance() > params_.maximum_rms_px * params_.maximum_rms_px) return;
  // But they do belong to the edge as far as they lie on it.
  const double reach_px = kReachShare * params_.line_tolerance_px;
  while (low < first && fit.offset(x_[low], y_[low]) > reach_px) ++low;
  while (high > last && fit.offset(x_[high], y_[high]) > reach_px) --high;
  // A point stands for its pixel: the edge reaches half a pixel beyond its middle.
  const double begin = fit.along(x_[low], y_[low]);
  const double end = fit.along(x_[high], y_[high]);
  const double way = end >= begin ? 0.5 : -0.5;
  const Segment2 px{fit.point(begin - way), fit.point(end + way)};
  if (px.length() < params_.piece_length_px) return;
  runs.push_back({px, fit.count()});
}

/// The bright side is on the left of the way d: the gradient should be along (d.y, -d.x).
bool LineRunFinder::agrees(const Fit& fit, int k, double sense) const {
  const double dot = sense * (fit.dy() * gx_[k] - fit.dx() * gy_[k]);
  return dot >= 0.0 && dot * dot >= agreement_[k];
}

}  // namespace vismem
