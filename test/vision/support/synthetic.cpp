#include "vision/support/synthetic.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/geometry/plane.h"

namespace vismem {
namespace {

constexpr int kSub = 8;

bool inside(const Quad& quad, const Eigen::Vector2d& p) {
  bool all_left = true;
  bool all_right = true;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d d = quad.corner[(i + 1) % 4] - quad.corner[i];
    const Eigen::Vector2d q = p - quad.corner[i];
    const double cross = cross2(d, q);
    all_left = all_left && cross >= 0.0;
    all_right = all_right && cross <= 0.0;
  }
  return all_left || all_right;
}

double coverageOf(const Quad& quad, int x, int y) {
  int hits = 0;
  for (int j = 0; j < kSub; ++j) {
    for (int i = 0; i < kSub; ++i) {
      hits += inside(quad, {x - 0.5 + (i + 0.5) / kSub, y - 0.5 + (j + 0.5) / kSub}) ? 1 : 0;
    }
  }
  return static_cast<double>(hits) / (kSub * kSub);
}

}  // namespace

Quad squareAt(const Eigen::Vector2d& middle, double side_px, double angle_rad) {
  const Eigen::Vector2d u = 0.5 * side_px * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d v(-u.y(), u.x());
  return {{middle - u - v, middle + u - v, middle + u + v, middle - u + v}};
}

Quad stripeAlong(const Segment2& middle_line, double width_px) {
  const Eigen::Vector2d d = (middle_line.b - middle_line.a).normalized();
  const Eigen::Vector2d aside = 0.5 * width_px * Eigen::Vector2d(-d.y(), d.x());
  return {{middle_line.a - aside, middle_line.b - aside, middle_line.b + aside, middle_line.a + aside}};
}

void fillQuad(cv::Mat& image, const Quad& quad, const cv::Scalar& color) {
  Eigen::Vector2d low = quad.corner[0];
  Eigen::Vector2d high = quad.corner[0];
  for (const auto& corner : quad.corner) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const int x1 = std::min(image.cols - 1, static_cast<int>(std::ceil(high.x() + 0.5)));
  const int y1 = std::min(image.rows - 1, static_cast<int>(std::ceil(high.y() + 0.5)));
  for (int y = std::max(0, static_cast<int>(std::floor(low.y() - 0.5))); y <= y1; ++y) {
    for (int x = std::max(0, static_cast<int>(std::floor(low.x() - 0.5))); x <= x1; ++x) {
      const double share = coverageOf(quad, x, y);
      for (int c = 0; c < image.channels(); ++c) {
        std::uint8_t& value = image.ptr<std::uint8_t>(y)[x * image.channels() + c];
        value = cv::saturate_cast<std::uint8_t>(value + share * (color[c] - value));
      }
    }
  }
}

void blur(cv::Mat& image, double sigma_px) {
  cv::GaussianBlur(image, image, cv::Size(), sigma_px);
}

void addNoise(cv::Mat& image, double sigma, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, sigma);
  for (int y = 0; y < image.rows; ++y) {
    std::uint8_t* row = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols * image.channels(); ++x) {
      row[x] = cv::saturate_cast<std::uint8_t>(row[x] + noise(random));
    }
  }
}

}  // namespace vismem
