#include "vision/support/synthetic_scenes.h"

#include <cmath>
#include <random>

#include "common/geometry/angles.h"
#include "vision/support/synthetic.h"

namespace vismem {
namespace {

constexpr int kColumns = 4;
constexpr int kRows = 2;
constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kBackground = 128.0;
constexpr double kBlur_px = 0.7;
constexpr double kBelongs_px = 5.0;
constexpr double kMaximumAngle_rad = degToRad(10.0);

/// One corner in each quarter of the cell, away from its borders: convex enough, edges of about 50 px.
Quad randomQuad(const Eigen::Vector2d& low, const Eigen::Vector2d& size, std::mt19937_64& random) {
  std::uniform_real_distribution<double> near(0.08, 0.32);
  const auto at = [&](bool right, bool down) {
    const double x = near(random);
    const double y = near(random);
    return Eigen::Vector2d(low.x() + size.x() * (right ? 1.0 - x : x),
                           low.y() + size.y() * (down ? 1.0 - y : y));
  };
  Quad quad;
  quad.corner[0] = at(false, false);
  quad.corner[1] = at(true, false);
  quad.corner[2] = at(true, true);
  quad.corner[3] = at(false, true);
  return quad;
}

}  // namespace

SyntheticScene makeScene(double noise_sigma, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> contrast(25.0, 60.0);
  SyntheticScene scene{cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(kBackground)), {}};
  const Eigen::Vector2d cell(static_cast<double>(kWidth) / kColumns, static_cast<double>(kHeight) / kRows);
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Eigen::Vector2d low(cell.x() * (i % kColumns), cell.y() * (i / kColumns));
    const Quad quad = randomQuad(low, cell, random);
    const double step = contrast(random) * (random() % 2 == 0 ? 1.0 : -1.0);
    fillQuad(scene.gray, quad, cv::Scalar::all(kBackground + step));
    for (int k = 0; k < 4; ++k) scene.edges.push_back({quad.corner[k], quad.corner[(k + 1) % 4]});
  }
  blur(scene.gray, kBlur_px);
  addNoise(scene.gray, noise_sigma, random);
  return scene;
}

cv::Mat makeNoise(double sigma, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  cv::Mat gray(kHeight, kWidth, CV_8UC1, cv::Scalar(kBackground));
  addNoise(gray, sigma, random);
  return gray;
}

double EndLineError::rms_px() const {
  return ends > 0 ? std::sqrt(squared_sum / static_cast<double>(ends)) : 0.0;
}

EndLineError endLineError(const std::vector<Segment2>& detected, const std::vector<Segment2>& edges) {
  EndLineError error;
  for (const Segment2& segment : detected) {
    const Segment2* best = nullptr;
    double best_px = kBelongs_px;
    for (const Segment2& edge : edges) {
      if (lineAngleDifference(segment.direction(), edge.direction()) > kMaximumAngle_rad) continue;
      const double distance = distanceToSegment(segment.middle(), edge);
      if (distance > best_px) continue;
      best_px = distance;
      best = &edge;
    }
    if (best == nullptr) continue;
    for (const Eigen::Vector2d& end : {segment.a, segment.b}) {
      error.squared_sum += std::pow(distanceToLine(end, *best), 2);
      ++error.ends;
    }
  }
  return error;
}

}  // namespace vismem
