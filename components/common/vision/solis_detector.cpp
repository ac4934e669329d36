// Our own detector: edge points, chains, runs of one direction fitted by total least squares (SPEC V1).
#include <algorithm>
#include <cmath>

#include "common/vision/collinear_merge.h"
#include "common/vision/edge_chains.h"
#include "common/vision/edge_points.h"
#include "common/vision/edge_sampling.h"
#include "common/vision/segment_detector.h"

namespace vismem {
namespace {

constexpr double kSideDistance_px = 2.0;
constexpr double kReachShare = 0.75;  // of the line tolerance: points that turn at a corner

/// Total least squares line from running sums, about an origin near the points for precision.
class LineFit {
 public:
  void reset(const ChainPoint& origin) {
    x0_ = origin.x;
    y0_ = origin.y;
    n_ = sx_ = sy_ = sxx_ = sxy_ = syy_ = 0.0;
  }
  void add(const ChainPoint& point) {
    const double x = point.x - x0_;
    const double y = point.y - y0_;
    n_ += 1.0;
    sx_ += x;
    sy_ += y;
    sxx_ += x * x;
    sxy_ += x * y;
    syy_ += y * y;
  }
  void solve() {
    mx_ = sx_ / n_;
    my_ = sy_ / n_;
    const double xx = sxx_ / n_ - mx_ * mx_;
    const double xy = sxy_ / n_ - mx_ * my_;
    const double yy = syy_ / n_ - my_ * my_;
    // Half-angle of (xx - yy, 2 xy) without trigonometry.
    const double c = xx - yy;
    const double s = 2.0 * xy;
    const double r = std::sqrt(c * c + s * s);
    dx_ = std::sqrt(std::max(0.0, 0.5 * (1.0 + (r > 0.0 ? c / r : 1.0))));
    dy_ = std::sqrt(std::max(0.0, 0.5 * (1.0 - (r > 0.0 ? c / r : 1.0))));
    if (s < 0.0) dy_ = -dy_;
    variance_ = std::max(0.0, 0.5 * (xx + yy - r));
  }
  double offset(const ChainPoint& p) const {
    return std::abs((p.x - x0_ - mx_) * dy_ - (p.y - y0_ - my_) * dx_);
  }
  double along(const ChainPoint& p) const { return (p.x - x0_ - mx_) * dx_ + (p.y - y0_ - my_) * dy_; }
  Eigen::Vector2d point(double along) const { return {x0_ + mx_ + along * dx_, y0_ + my_ + along * dy_}; }
  double rms() const { return std::sqrt(variance_); }
  double count() const { return n_; }
  double dx() const { return dx_; }
  double dy() const { return dy_; }

 private:
  double x0_ = 0.0, y0_ = 0.0;
  double n_ = 0.0, sx_ = 0.0, sy_ = 0.0, sxx_ = 0.0, sxy_ = 0.0, syy_ = 0.0;
  double mx_ = 0.0, my_ = 0.0, dx_ = 1.0, dy_ = 0.0, variance_ = 0.0;
};

class SolisDetector final : public SegmentDetector {
 public:
  explicit SolisDetector(const SolisParams& params) : params_(params) {}

  void detect(const cv::Mat& image, std::vector<RawSegment>& out) override {
    out.clear();
    const cv::Mat gray = toGray(image);
    if (gray.cols < 16 || gray.rows < 16) return;
    // Noise of the gradient, in the contrast of the step that would give it.
    const double noise_contrast = estimateNoise(gray) * noiseMagnitude() / stepMagnitude();
    const double contrast = std::max(params_.minimum_contrast, params_.noise_factor * noise_contrast);
    findEdgePoints(gray, contrast, planes_);
    followChains(planes_, params_.gap_px, chains_, begins_);
    pieces_.clear();
    for (std::size_t i = 0; i + 1 < begins_.size(); ++i) splitChain(begins_[i], begins_[i + 1]);
    const CollinearMergeParams merge{params_.merge_angle_rad, params_.merge_offset_px, params_.merge_gap_px};
    for (const GroupedSegment& piece : mergeCollinear(pieces_, merge)) {
      if (piece.px.length() < params_.minimum_length_px) continue;
      const OrientedSegment oriented = orientByBrightness(gray, piece.px, kSideDistance_px);
      // The gradient along the edge has decided which side is brighter; samples may disagree on a thin
      // stripe.
      out.push_back({piece.px, oriented.strength});
    }
  }

 private:
  /// Cuts the points [begin, end) of one chain into straight runs; the point that breaks a run begins the
  /// next.
  void splitChain(int begin, int end) {
    const int window = params_.first_fit_points;
    int free_from = begin;  // points before it belong to an earlier run; runs share the point between them
    int i = begin;
    LineFit fit;
    while (i + window <= end) {
      fit.reset(chains_[i]);
      for (int k = i; k < i + window; ++k) fit.add(chains_[k]);
      fit.solve();
      if (fit.rms() > params_.first_fit_rms_px) {
        ++i;
        continue;
      }
      const int last = extend(fit, i + window, end, 1);
      const int first = extend(fit, i - 1, free_from - 1, -1);
      emit(fit, first, last);
      free_from = last;
      i = last;
    }
  }

  /// Adds points from `from` towards `stop` (excluded) while they lie on the line; a few strays are passed
  /// over.
  /// @return the last point on the line, or the one before `from` if none.
  int extend(LineFit& fit, int from, int stop, int step) const {
    int last = from - step;
    int strays = 0;
    for (int k = from; k != stop; k += step) {
      if (fit.offset(chains_[k]) <= params_.line_tolerance_px) {
        fit.add(chains_[k]);
        fit.solve();
        last = k;
        strays = 0;
      } else if (++strays > params_.maximum_strays) {
        break;
      }
    }
    return last;
  }

  void emit(LineFit& fit, int first, int last) {
    // Chains run with the bright side on the left, so first -> last keeps that.
    double sense = fit.along(chains_[last]) >= fit.along(chains_[first]) ? 1.0 : -1.0;
    // Round a corner the gradient turns before the points leave the line: those would bend the fit.
    int low = first;
    int high = last;
    while (first < last && !agrees(fit, chains_[first], sense)) ++first;
    while (last > first && !agrees(fit, chains_[last], sense)) --last;
    if (last - first + 1 < params_.first_fit_points) return;
    LineFit refined;
    refined.reset(chains_[first]);
    int agreeing = 0;
    for (int k = first; k <= last; ++k) {
      if (fit.offset(chains_[k]) <= params_.line_tolerance_px) refined.add(chains_[k]);
      if (agrees(fit, chains_[k], sense)) ++agreeing;
    }
    // Enough points whose own gradient agrees with the line: what chains of noise lack.
    if (agreeing < params_.alignment_share * (last - first + 1)) return;
    refined.solve();
    if (refined.rms() > params_.maximum_rms_px) return;
    sense = refined.along(chains_[last]) >= refined.along(chains_[first]) ? 1.0 : -1.0;
    // But they do belong to the edge as far as they lie on it.
    const double reach_px = kReachShare * params_.line_tolerance_px;
    while (low < first && refined.offset(chains_[low]) > reach_px) ++low;
    while (high > last && refined.offset(chains_[high]) > reach_px) --high;
    // A point stands for its pixel: the edge reaches half a pixel beyond its middle.
    const Segment2 px{refined.point(refined.along(chains_[low]) - 0.5 * sense),
                      refined.point(refined.along(chains_[high]) + 0.5 * sense)};
    const double length = px.length();
    if (length < params_.piece_length_px) return;
    pieces_.push_back({px, 0, refined.count() / length, 0.0});
  }

  /// The bright side is on the left of the way d: the gradient should be along (d.y, -d.x).
  bool agrees(const LineFit& fit, const ChainPoint& point, double sense) const {
    const double dot = sense * (fit.dy() * planes_.gx[point.index] - fit.dx() * planes_.gy[point.index]);
    return dot >= params_.alignment_cos * planes_.magnitude[point.index];
  }

  SolisParams params_;
  EdgePlanes planes_;
  std::vector<ChainPoint> chains_;
  std::vector<std::int32_t> begins_;
  std::vector<GroupedSegment> pieces_;
};

}  // namespace

std::unique_ptr<SegmentDetector> makeSolisDetector(const SolisParams& params) {
  return std::make_unique<SolisDetector>(params);
}

}  // namespace vismem
