#include "calibration/core/target/saddle_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "calibration/core/board.h"

namespace vismem {
namespace {

constexpr double kMinRadius_px = 3.0;
constexpr double kMaxRadius_px = 10.0;
/// Reach of the window, in squares.
constexpr double kReach = 0.45;
/// Blur reaches this far over the border of a tag [px]. Of small squares a strip along the edges remains, in
/// squares.
constexpr double kTagBlur_px = 2.5;
constexpr double kMinStrip = 0.02;
constexpr double kMinContrast = 8.0;
/// Largest standard deviation of the residuals, as a share of the contrast, and the same in grey levels.
constexpr double kMaxMisfit = 0.25;
constexpr double kMaxSigma_px = 0.5;

/// x, y, angle of each edge, blur, contrast; brightness at the corner and its slopes.
constexpr int kUnknowns = 9;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
enum Unknown { kX, kY, kAngle1, kAngle2, kBlur, kContrast, kLevel, kSlopeX, kSlopeY };

struct WindowPixel {
  double u = 0.0;
  double v = 0.0;
  double grey = 0.0;
  double weight = 0.0;  ///< of the residual
};

/// The pixels around the guess that show the four squares only.
std::vector<WindowPixel> windowAround(const cv::Mat& grey, const SaddleGuess& guess) {
  Eigen::Matrix2d squares;
  squares << guess.right, guess.up;
  const double side = std::min({guess.right.norm(), guess.up.norm(), (guess.right + guess.up).norm(),
                                (guess.right - guess.up).norm()});
  const double radius = std::min(kMaxRadius_px, kReach * side);
  const double tag = std::max(kMinStrip, 0.5 * (1.0 - BoardSpec::kTagSide) - kTagBlur_px / side);
  if (radius < kMinRadius_px || std::abs(squares.determinant()) < 0.15 * guess.right.norm() * guess.up.norm())
    return {};
  const Eigen::Matrix2d toSquares = squares.inverse();
  const int reach = static_cast<int>(std::ceil(radius));
  const int column = static_cast<int>(std::lround(guess.px.x()));
  const int row = static_cast<int>(std::lround(guess.px.y()));
  if (column < reach || row < reach || column + reach >= grey.cols || row + reach >= grey.rows) return {};
  std::vector<WindowPixel> window;
  for (int v = row - reach; v <= row + reach; ++v) {
    for (int u = column - reach; u <= column + reach; ++u) {
      const Eigen::Vector2d offset = Eigen::Vector2d(u, v) - guess.px;
      const double weight = 1.0 - offset.squaredNorm() / (radius * radius);
      if (weight <= 0.0) continue;
      const Eigen::Vector2d at = toSquares * offset;
      const bool is_white = (at.x() * at.y() > 0.0) == guess.is_upper_right_white;
      if (is_white && std::min(std::abs(at.x()), std::abs(at.y())) > tag) continue;
      window.push_back({static_cast<double>(u), static_cast<double>(v),
                        static_cast<double>(grey.at<unsigned char>(v, u)), weight});
    }
  }
  return window;
}

/// Residual and derivative of one pixel.
double residualOf(const WindowPixel& pixel, const Unknowns& x, Unknowns* slope) {
  const double du = pixel.u - x[kX];
  const double dv = pixel.v - x[kY];
  const double c1 = std::cos(x[kAngle1]);
  const double s1 = std::sin(x[kAngle1]);
  const double c2 = std::cos(x[kAngle2]);
  const double s2 = std::sin(x[kAngle2]);
  const double scale = 1.0 / (std::numbers::sqrt2 * x[kBlur]);
  const double d1 = (c1 * dv - s1 * du) * scale;
  const double d2 = (c2 * dv - s2 * du) * scale;
  const double e1 = std::erf(d1);
  const double e2 = std::erf(d2);
  if (slope) {
    const double peak = 2.0 * std::numbers::inv_sqrtpi;
    const double g1 = x[kContrast] * peak * std::exp(-d1 * d1) * e2;
    const double g2 = x[kContrast] * peak * std::exp(-d2 * d2) * e1;
    (*slope)[kX] = (g1 * s1 + g2 * s2) * scale - x[kSlopeX];
    (*slope)[kY] = -(g1 * c1 + g2 * c2) * scale - x[kSlopeY];
    (*slope)[kAngle1] = -g1 * (s1 * dv + c1 * du) * scale;
    (*slope)[kAngle2] = -g2 * (s2 * dv + c2 * du) * scale;
    (*slope)[kBlur] = -(g1 * d1 + g2 * d2) / x[kBlur];
    (*slope)[kContrast] = e1 * e2;
    (*slope)[kLevel] = 1.0;
    (*slope)[kSlopeX] = du;
    (*slope)[kSlopeY] = dv;
  }
  return x[kLevel] + x[kSlopeX] * du + x[kSlopeY] * dv + x[kContrast] * e1 * e2 - pixel.grey;
}

double costOf(const std::vector<WindowPixel>& window, const Unknowns& x) {
  double cost = 0.0;
  for (const WindowPixel& pixel : window) {
    const double r = residualOf(pixel, x, nullptr);
    cost += pixel.weight * r * r;
  }
  return cost;
}

Unknowns startAt(const std::vector<WindowPixel>& window, const SaddleGuess& guess) {
  double sum = 0.0;
  double least = 255.0;
  double most = 0.0;
  for (const WindowPixel& pixel : window) {
    sum += pixel.grey;
    least = std::min(least, pixel.grey);
    most = std::max(most, pixel.grey);
  }
  Unknowns x = Unknowns::Zero();
  x[kX] = guess.px.x();
  x[kY] = guess.px.y();
  // d1 is positive above the edge along `right`, d2 to the right of the edge along `up` (v points down).
  x[kAngle1] = std::atan2(-guess.right.y(), -guess.right.x());
  x[kAngle2] = std::atan2(guess.up.y(), guess.up.x());
  x[kBlur] = 1.0;
  x[kContrast] = (guess.is_upper_right_white ? 0.5 : -0.5) * (most - least);
  x[kLevel] = sum / static_cast<double>(window.size());
  return x;
}

/// Levenberg-Marquardt. @return whether it has converged.
bool minimise(const std::vector<WindowPixel>& window, Unknowns& x) {
  constexpr int kMaxIterations = 40;
  constexpr double kEnough_px = 1e-4;
  double damping = 1e-3;
  double cost = costOf(window, x);
  for (int i = 0; i < kMaxIterations; ++i) {
    Normal H = Normal::Zero();
    Unknowns g = Unknowns::Zero();
    for (const WindowPixel& pixel : window) {
      Unknowns slope;
      const double r = residualOf(pixel, x, &slope);
      H.noalias() += pixel.weight * slope * slope.transpose();
      g += pixel.weight * r * slope;
    }
    H.diagonal() *= 1.0 + damping;
    const Unknowns step = -H.ldlt().solve(g);
    if (!step.allFinite()) return false;
    Unknowns next = x + step;
    next[kBlur] = std::clamp(next[kBlur], 0.25, 8.0);
    const double next_cost = costOf(window, next);
    if (next_cost > cost) {
      damping *= 10.0;
      if (damping > 1e6) return true;
      continue;
    }
    damping = std::max(1e-9, 0.2 * damping);
    x = next;
    cost = next_cost;
    if (step.head<2>().norm() < kEnough_px) return true;
  }
  return false;
}

/// Standard deviation of a pixel's residual, and of the corner. Residuals are largest at the edges, which place
/// the corner: each pixel counts with its own (sandwich estimator of White 1980, HC1).
std::pair<double, double> spreadOf(const std::vector<WindowPixel>& window, const Unknowns& x) {
  Normal H = Normal::Zero();
  Normal noise = Normal::Zero();
  double squares = 0.0;
  double weights = 0.0;
  for (const WindowPixel& pixel : window) {
    Unknowns slope;
    const double weighted = pixel.weight * residualOf(pixel, x, &slope);
    H.noalias() += pixel.weight * slope * slope.transpose();
    noise.noalias() += weighted * weighted * slope * slope.transpose();
    squares += weighted * weighted / pixel.weight;
    weights += pixel.weight;
  }
  const auto count = static_cast<double>(window.size());
  const double freedom = count / (count - kUnknowns);
  const Normal inverse = H.ldlt().solve(Normal::Identity());
  const Normal P = freedom * inverse * noise * inverse;
  return {std::sqrt(freedom * squares / weights), std::sqrt(0.5 * (P(0, 0) + P(1, 1)))};
}

}  // namespace

std::optional<SaddleFit> fitSaddle(const cv::Mat& grey, const SaddleGuess& guess) {
  const auto window = windowAround(grey, guess);
  if (window.size() < 3 * kUnknowns) return std::nullopt;
  Unknowns x = startAt(window, guess);
  const double side = std::min(guess.right.norm(), guess.up.norm());
  if (std::abs(x[kContrast]) < kMinContrast || !minimise(window, x)) return std::nullopt;
  const auto [misfit, sigma_px] = spreadOf(window, x);
  SaddleFit fit{x.head<2>(), sigma_px, x[kBlur], std::abs(x[kContrast])};
  const bool is_turned = (x[kContrast] > 0.0) != guess.is_upper_right_white;
  // The edges must still run along the board's directions, to 20 degrees.
  const Eigen::Vector2d right(-std::cos(x[kAngle1]), -std::sin(x[kAngle1]));
  const Eigen::Vector2d up(std::cos(x[kAngle2]), std::sin(x[kAngle2]));
  const bool is_askew =
      right.dot(guess.right) < 0.94 * guess.right.norm() || up.dot(guess.up) < 0.94 * guess.up.norm();
  if (is_turned || is_askew || fit.contrast < kMinContrast || misfit > kMaxMisfit * fit.contrast ||
      !(sigma_px < kMaxSigma_px) || fit.blur_px > 0.2 * side || (fit.px - guess.px).norm() > 0.25 * side)
    return std::nullopt;
  return fit;
}

}  // namespace vismem
