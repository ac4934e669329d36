#include "common/vision/line_runs.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace vismem {
namespace {

constexpr int kRingOverlap = 16;      // points of a ring that come again at its end
constexpr int kPrefetched = 16000;    // points: of the rows below, in which chains go on
constexpr int kPointsPerLine = 4;     // of the cache
constexpr int kFetchedTogether = 32;  // points whose links fill such a line
constexpr double kReachShare = 0.75;  // of the line tolerance: points that turn at a corner

}  // namespace

/// Which points lie on the line of others: without roots and divisions. The line is that of least squares
/// along the axis nearest to it.
class LineRunFinder::Line {
 public:
  Line(const Sums& sums, double tolerance_px) {
    const double xx = sums.n * sums.xx - sums.x * sums.x;
    const double xy = sums.n * sums.xy - sums.x * sums.y;
    const double yy = sums.n * sums.yy - sums.y * sums.y;
    dx_ = xx >= yy ? xx : xy;
    dy_ = xx >= yy ? xy : yy;
    nx_ = -dy_ * sums.n;
    ny_ = dx_ * sums.n;
    offset_ = dx_ * sums.y - dy_ * sums.x;
    limit_ = tolerance_px * tolerance_px * (nx_ * nx_ + ny_ * ny_);
  }
  bool has(const Place& p) const {
    const double aside = p.x * nx_ + p.y * ny_ - offset_;
    return aside * aside <= limit_;
  }
  /// Along the line; of any length.
  double dx() const { return dx_; }
  double dy() const { return dy_; }

 private:
  double dx_, dy_, nx_, ny_, offset_, limit_;
};

/// Total least squares line.
class LineRunFinder::Fit {
 public:
  explicit Fit(const Sums& sums) {
    const double scale = 1.0 / sums.n;
    mx_ = sums.x * scale;
    my_ = sums.y * scale;
    const double xx = sums.xx * scale - mx_ * mx_;
    const double xy = sums.xy * scale - mx_ * my_;
    const double yy = sums.yy * scale - my_ * my_;
    // Half-angle of (xx - yy, 2 xy) without trigonometry.
    const double c = xx - yy;
    const double s = 2.0 * xy;
    const double r = std::sqrt(c * c + s * s);
    const double cos_twice = r > 0.0 ? c / r : 1.0;
    dx_ = std::sqrt(std::max(0.0, 0.5 * (1.0 + cos_twice)));
    dy_ = std::copysign(std::sqrt(std::max(0.0, 0.5 * (1.0 - cos_twice))), s);
    variance_ = std::max(0.0, 0.5 * (xx + yy - r));
    offset_ = mx_ * dy_ - my_ * dx_;
    along_ = mx_ * dx_ + my_ * dy_;
  }
  double offset(const Place& p) const { return std::abs(p.x * dy_ - p.y * dx_ - offset_); }
  double along(const Place& p) const { return p.x * dx_ + p.y * dy_ - along_; }
  Eigen::Vector2d point(double along) const { return {mx_ + along * dx_, my_ + along * dy_}; }
  double variance() const { return variance_; }

 private:
  double mx_ = 0.0, my_ = 0.0, dx_ = 1.0, dy_ = 0.0, variance_ = 0.0;
  double offset_ = 0.0, along_ = 0.0;
};

void LineRunFinder::find(const EdgePointFinder& edges, std::vector<LineRun>& runs) {
  runs.clear();
  const int count = edges.count();
  const std::size_t room = static_cast<std::size_t>(edges.capacity()) + 2 * kEdgePointBlock;
  starts_.reserve(room);
  tops_.reserve(room);
  used_.reserve(room);
  strays_.reserve(room);
  agrees_.reserve(room);
  sums_.reserve(room + 1);
  place_.reserve(room);
  gradient_.reserve(room);
  std::memset(used_.data(), 0, count);
  const EdgeChainEnds found = edges.listStarts(starts_.data(), tops_.data());
  const int chains = keepLong(edges, starts_.data(), found.starts);
  std::int32_t fetched = 0;
  for (int k = 0; k < chains; ++k) {
    const std::int32_t first = starts_[k];
    for (const std::int32_t end = std::min(first + kPrefetched, count); fetched < end;
         fetched += kFetchedTogether) {
      for (int i = 0; i < kFetchedTogether; i += kPointsPerLine)
        __builtin_prefetch(edges.points() + fetched + i, 0, 2);
      __builtin_prefetch(edges.next() + fetched, 0, 2);
    }
    split(follow(edges, first, false), runs);
  }
  // The first point of a ring is the one that no chain has reached.
  const int rings = keepLong(edges, tops_.data(), found.tops);
  for (int k = 0; k < rings; ++k) {
    if (used_[tops_[k]] == 0) split(follow(edges, tops_[k], true), runs);
  }
}

/// Of points where chains begin, keeps those from which a run can begin: most chains are too short.
/// @return how many.
int LineRunFinder::keepLong(const EdgePointFinder& edges, std::int32_t* starts, int count) const {
  const std::int16_t* next = edges.next();
  const int steps = params_.first_fit_points - 2;
  int kept = 0;
  for (int k = 0; k < count; ++k) {  // without a branch: an end is its own next one
    const std::int32_t first = starts[k];
    std::int32_t i = first;
    for (int step = 0; step < steps; ++step) i += next[i];
    starts[kept] = first;
    kept += static_cast<int>(next[i] != 0);
  }
  return kept;
}

/// Lists the points of a chain, and sums over them. A ring begins anywhere on a side: going on over its
/// beginning shows that side whole.
/// @return how many points.
int LineRunFinder::follow(const EdgePointFinder& edges, std::int32_t first, bool ring) {
  // Members are read before: the compiler must take a write of bytes for one to any of them.
  const EdgePoint* points = edges.points();
  const std::int16_t* next = edges.next();
  const double x0 = x0_ = points[first].x;
  const double y0 = y0_ = points[first].y;
  std::uint8_t* used = used_.data();
  Place* place = place_.data();
  Gradient* gradient = gradient_.data();
  Sums* sums = sums_.data();
  Sums all;
  int length = 0;
  std::int32_t i = first;
  const auto add = [&](const Place& at, const Gradient& g) {
    place[length] = at;
    gradient[length] = g;
    sums[length] = all;
    all.add(at.x, at.y);
    ++length;
  };
  for (;;) {
    const EdgePoint& p = points[i];
    add({p.x - x0, p.y - y0}, {p.gx, p.gy});
    used[i] = 1;
    const int step = next[i];
    i += step;
    if (step == 0 || (ring && i == first)) break;
  }
  if (ring && length >= 2 * kRingOverlap) {
    for (int k = 0; k < kRingOverlap; ++k) add(place[k], gradient[k]);
  }
  sums[length] = all;
  return length;
}

void LineRunFinder::split(int count, std::vector<LineRun>& runs) {
  const int window = params_.first_fit_points;
  const double first_variance = params_.first_fit_rms_px * params_.first_fit_rms_px;
  int free_from = 0;  // points before it belong to an earlier run; runs share the point between them
  for (int i = 0; i + window <= count;) {
    Sums run = sums_[i + window] - sums_[i];
    if (!run.thin(first_variance)) {
      ++i;
      continue;
    }
    stray_count_ = 0;
    const int last = extend<1>(run, i + window, count);
    const int first = extend<-1>(run, i - 1, free_from - 1);
    emit(run, first, last, runs);
    free_from = last;
    i = last;
  }
}

/// Adds points from `from` towards `stop` (excluded) while they lie on the line; a few strays are passed
/// over.
/// @return the last point on the line, or the one before `from` if none.
template <int kStep>
inline __attribute__((always_inline)) int LineRunFinder::extend(Sums& run, int from, int stop) {
  if (from == stop) return from - kStep;
  // Members are read before: the compiler must take a write of bytes for one to any of them.
  const Place* place = place_.data();
  const Sums* sums = sums_.data();
  const double tolerance_px = params_.line_tolerance_px;
  const int maximum_strays = params_.maximum_strays;
  Line line(run, tolerance_px);
  int strays = 0;
  int last = from - kStep;
  for (int k = from; k != stop; k += kStep) {
    const int begin = k;
    while (k != stop && line.has(place[k])) k += kStep;
    if (k != begin) {
      // The line follows its points when it would break off.
      const int low = kStep > 0 ? begin : k + 1;
      const int high = kStep > 0 ? k : begin + 1;
      run += sums[high] - sums[low];
      last = k - kStep;
      strays = 0;
      if (k == stop) break;
      line = Line(run, tolerance_px);
      if (line.has(place[k])) {
        k -= kStep;
        continue;
      }
    }
    strays_[stray_count_++] = k;
    if (++strays > maximum_strays) break;
  }
  return last;
}

/// Takes points begin..end-1 out of a run, but for strays, which are not in it.
void LineRunFinder::leaveOut(Sums& run, int begin, int end) const {
  run += sums_[begin] - sums_[end];
  for (int i = 0; i < stray_count_; ++i) {
    const int k = strays_[i];
    if (k >= begin && k < end) run += sums_[k + 1] - sums_[k];
  }
}

void LineRunFinder::emit(Sums& run, int first, int last, std::vector<LineRun>& runs) {
  const Place* place = place_.data();
  // Chains run with the bright side on the left, so first -> last keeps that.
  const Line line(run, params_.line_tolerance_px);
  const bool backward =
      (place[last].x - place[first].x) * line.dx() + (place[last].y - place[first].y) * line.dy() < 0.0;
  // Enough points whose own gradient agrees with the line: what chains of noise lack.
  const int agreeing = countAgreeing(line, first, last, backward);
  // Round a corner the gradient turns before the points leave the line: those would bend the fit.
  int low = first;
  int high = last;
  while (first < last && agrees_[first - low] == 0) ++first;
  while (last > first && agrees_[last - low] == 0) --last;
  if (last - first + 1 < params_.first_fit_points) return;
  if (agreeing < params_.alignment_share * (last - first + 1)) return;
  if (low != first) leaveOut(run, low, first);
  if (high != last) leaveOut(run, last + 1, high + 1);
  const Fit fit(run);
  if (fit.variance() > params_.maximum_rms_px * params_.maximum_rms_px) return;
  // But they do belong to the edge as far as they lie on it.
  const double reach_px = kReachShare * params_.line_tolerance_px;
  while (low < first && fit.offset(place[low]) > reach_px) ++low;
  while (high > last && fit.offset(place[high]) > reach_px) --high;
  // A point stands for its pixel: the edge reaches half a pixel beyond its middle.
  const double begin = fit.along(place[low]);
  const double end = fit.along(place[high]);
  const double way = end >= begin ? 0.5 : -0.5;
  if (std::abs(end - begin) + 1.0 < params_.piece_length_px) return;
  const Eigen::Vector2d origin(x0_, y0_);
  runs.push_back({{origin + fit.point(begin - way), origin + fit.point(end + way)}, run.n});
}

/// How many points have a gradient that agrees with the line. The bright side is on the left of the way d:
/// the gradient should be along (d.y, -d.x).
int LineRunFinder::countAgreeing(const Line& line, int first, int last, bool backward) {
  // The larger part is 1, so that squares fit a float.
  const double larger = std::max({std::abs(line.dx()), std::abs(line.dy()), 1e-300});
  const double scale = (backward ? -1.0 : 1.0) / larger;
  const auto nx = static_cast<float>(scale * line.dy());
  const auto ny = static_cast<float>(-scale * line.dx());
  const float cosine_squared = static_cast<float>(params_.alignment_cos * params_.alignment_cos);
  const float limit = cosine_squared * (nx * nx + ny * ny);
  const int count = last - first + 1;
  const Gradient* __restrict gradient = gradient_.data() + first;
  std::int32_t* __restrict agrees = agrees_.data();
  int agreeing = 0;
  for (int k = 0; k < count; ++k) {
    const auto gx = static_cast<float>(gradient[k].x);
    const auto gy = static_cast<float>(gradient[k].y);
    const float dot = nx * gx + ny * gy;
    const std::int32_t yes = static_cast<std::int32_t>(dot >= 0.0F) &
                             static_cast<std::int32_t>(dot * dot >= limit * (gx * gx + gy * gy));
    agrees[k] = yes;
    agreeing += yes;
  }
  return agreeing;
}

}  // namespace vismem
