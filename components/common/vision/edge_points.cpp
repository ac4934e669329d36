#include "common/vision/edge_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace vismem {
namespace {

/// Binomial 3x3 without division (sum of weights 16): out has the image's size, borders replicated.
void smoothBinomial(const cv::Mat& gray, EdgePlanes& planes) {
  const int width = gray.cols;
  const int height = gray.rows;
  planes.smooth.resize(static_cast<std::size_t>(width) * height);
  planes.column_sum.resize(width);
  std::uint16_t* sum = planes.column_sum.data();
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* above = gray.ptr<std::uint8_t>(std::max(y - 1, 0));
    const std::uint8_t* here = gray.ptr<std::uint8_t>(y);
    const std::uint8_t* below = gray.ptr<std::uint8_t>(std::min(y + 1, height - 1));
    for (int x = 0; x < width; ++x) sum[x] = static_cast<std::uint16_t>(above[x] + 2 * here[x] + below[x]);
    std::uint16_t* out = planes.smooth.data() + static_cast<std::size_t>(y) * width;
    out[0] = static_cast<std::uint16_t>(3 * sum[0] + sum[1]);
    for (int x = 1; x + 1 < width; ++x)
      out[x] = static_cast<std::uint16_t>(sum[x - 1] + 2 * sum[x] + sum[x + 1]);
    out[width - 1] = static_cast<std::uint16_t>(sum[width - 2] + 3 * sum[width - 1]);
  }
}

/// Sobel on the smoothed image, halved twice so that it fits 16 bits: |gx| <= 4 * 255 * 16 / 4 = 4080.
void sobel(EdgePlanes& planes) {
  const int width = planes.width;
  const int height = planes.height;
  const std::size_t size = static_cast<std::size_t>(width) * height;
  planes.gx.assign(size, 0);
  planes.gy.assign(size, 0);
  planes.magnitude.assign(size, 0.0F);
  for (int y = 1; y + 1 < height; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * width;
    const std::uint16_t* above = planes.smooth.data() + begin - width;
    const std::uint16_t* here = planes.smooth.data() + begin;
    const std::uint16_t* below = planes.smooth.data() + begin + width;
    std::int16_t* gx = planes.gx.data() + begin;
    std::int16_t* gy = planes.gy.data() + begin;
    float* magnitude = planes.magnitude.data() + begin;
    for (int x = 1; x + 1 < width; ++x) {
      const int dx =
          (above[x + 1] - above[x - 1]) + 2 * (here[x + 1] - here[x - 1]) + (below[x + 1] - below[x - 1]);
      const int dy =
          (below[x - 1] - above[x - 1]) + 2 * (below[x] - above[x]) + (below[x + 1] - above[x + 1]);
      gx[x] = static_cast<std::int16_t>(dx / 4);
      gy[x] = static_cast<std::int16_t>(dy / 4);
    }
    for (int x = 1; x + 1 < width; ++x) {
      magnitude[x] = std::sqrt(static_cast<float>(gx[x] * gx[x] + gy[x] * gy[x]));
    }
  }
}

/// Largest across the edge, along the axis nearest to the gradient: one point per row of a steep edge and per
/// column of a flat one, so that chains are one point wide.
void suppress(float minimum, EdgePlanes& planes) {
  const int width = planes.width;
  planes.is_edge.assign(planes.gx.size(), 0);
  planes.edges.clear();
  for (int y = 2; y + 2 < planes.height; ++y) {
    const int begin = y * width;
    for (int x = 2; x + 2 < width; ++x) {
      const int i = begin + x;
      const float m = planes.magnitude[i];
      if (m < minimum) continue;
      const int across = std::abs(planes.gx[i]) >= std::abs(planes.gy[i]) ? 1 : width;
      if (m <= planes.magnitude[i - across] || m < planes.magnitude[i + across]) continue;
      planes.is_edge[i] = 1;
      planes.edges.push_back(i);
    }
  }
}

}  // namespace

double stepMagnitude() {
  // Across a step between two pixels the binomial gives 1/4, 3/4 of it beside: the Sobel difference there is
  // 4 * 16 * (1 - 1/4) = 48, a quarter of it is kept.
  return 12.0;
}

double noiseMagnitude() {
  // gx is the convolution with [1 2 1] * [1 2 1] down and [1 2 1] * [-1 0 1] across, over 4:
  // sqrt(1 + 16 + 36 + 16 + 1) * sqrt(1 + 4 + 0 + 4 + 1) / 4.
  return std::sqrt(70.0) * std::sqrt(10.0) / 4.0;
}

double estimateNoise(const cv::Mat& gray) {
  // Second difference along x of the second difference along y: weights 1 -2 1 each way, deviation 6 sigma.
  constexpr double kDeviation = 6.0;
  constexpr double kLowerQuartile = 0.3186;  // of |x| for a normal x of deviation 1
  std::array<int, 8 * 256 * 2 + 1> histogram{};
  int total = 0;
  for (int y = 1; y + 1 < gray.rows; y += 2) {
    const std::uint8_t* above = gray.ptr<std::uint8_t>(y - 1);
    const std::uint8_t* here = gray.ptr<std::uint8_t>(y);
    const std::uint8_t* below = gray.ptr<std::uint8_t>(y + 1);
    for (int x = 1; x + 1 < gray.cols; x += 2) {
      const int value = above[x - 1] - 2 * above[x] + above[x + 1] -
                        2 * (here[x - 1] - 2 * here[x] + here[x + 1]) + below[x - 1] - 2 * below[x] +
                        below[x + 1];
      ++histogram[std::abs(value)];
      ++total;
    }
  }
  if (total == 0) return 0.0;
  // The quartile between integer values, by linear interpolation inside its bin [k - 1/2, k + 1/2].
  const double wanted = 0.25 * total;
  double below_count = 0.0;
  for (std::size_t k = 0; k < histogram.size(); ++k) {
    if (below_count + histogram[k] >= wanted) {
      const double width = k == 0 ? 0.5 : 1.0;
      const double low = k == 0 ? 0.0 : static_cast<double>(k) - 0.5;
      return (low + width * (wanted - below_count) / std::max(histogram[k], 1)) /
             (kDeviation * kLowerQuartile);
    }
    below_count += histogram[k];
  }
  return 0.0;
}

void findEdgePoints(const cv::Mat& gray, double minimum_contrast, EdgePlanes& planes) {
  planes.width = gray.cols;
  planes.height = gray.rows;
  smoothBinomial(gray, planes);
  sobel(planes);
  suppress(static_cast<float>(minimum_contrast * stepMagnitude()), planes);
}

}  // namespace vismem
