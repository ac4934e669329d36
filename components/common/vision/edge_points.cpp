#include "common/vision/edge_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

/// `first` unless it is negative. Without a branch.
std::int32_t either(std::int32_t first, std::int32_t second) {
  const std::int32_t negative = first >> 31;
  return (first & ~negative) | (second & negative);
}

/// For |value| < 8, without a call.
int nearest(float value) {
  return static_cast<int>(value + 8.5F) - 8;
}

constexpr float kMinimumSquaredCos = 0.5F;  // between the gradients of neighbours

}  // namespace

double stepMagnitude() {
  // Across a step between two pixels the binomial gives 1/4, 3/4 of it beside: the Sobel difference there is
  // 4 * 16 * (1 - 1/4).
  return 48.0;
}

double noiseMagnitude() {
  // [1 4 6 4 1] along the edge times [-1 -2 0 2 1] across it.
  return std::sqrt(1.0 + 16.0 + 36.0 + 16.0 + 1.0) * std::sqrt(1.0 + 4.0 + 0.0 + 4.0 + 1.0);
}

double estimateNoise(const cv::Mat& image) {
  // Second difference along x of the second difference along y: weights 1 -2 1 each way, deviation 6 sigma.
  constexpr double kDeviation = 6.0;
  constexpr double kLowerQuartile = 0.3186;  // of |x| for a normal x of deviation 1
  constexpr int kAlong = 96;                 // places in each direction, at most
  constexpr int kDown = 48;
  if (image.cols < 3 || image.rows < 3) return 0.0;
  std::array<std::uint16_t, 8 * 256 + 1> histogram{};
  const int step_x = std::max(2, (image.cols - 2) / kAlong);
  const int step_y = std::max(2, (image.rows - 2) / kDown);
  const int channels = image.channels();
  int total = 0;
  for (int y = 1; y + 1 < image.rows; y += step_y) {
    const std::uint8_t* above = image.ptr<std::uint8_t>(y - 1);
    const std::uint8_t* here = image.ptr<std::uint8_t>(y);
    const std::uint8_t* below = image.ptr<std::uint8_t>(y + 1);
    for (int x = 1; x + 1 < image.cols; x += step_x) {
      const auto column = [&](int at) {
        return brightness(above, at, channels) - 2 * brightness(here, at, channels) +
               brightness(below, at, channels);
      };
      ++histogram[std::abs(column(x - 1) - 2 * column(x) + column(x + 1))];
      ++total;
    }
  }
  // The quartile between integer values, by linear interpolation inside its bin [k - 1/2, k + 1/2].
  const double wanted = 0.25 * total;
  double below_count = 0.0;
  for (std::size_t k = 0; k < histogram.size(); ++k) {
    if (below_count + histogram[k] >= wanted) {
      const double width = k == 0 ? 0.5 : 1.0;
      const double low = k == 0 ? 0.0 : static_cast<double>(k) - 0.5;
      return (low + width * (wanted - below_count) / std::max<int>(histogram[k], 1)) /
             (kDeviation * kLowerQuartile);
    }
    below_count += histogram[k];
  }
  return 0.0;
}

void EdgePointFinder::prepare(const cv::Mat& image) {
  width_ = image.cols;
  height_ = image.rows;
  stride_ = width_ + 2 * kEdgeRowMargin;
  map_stride_ = width_ + 2 * kMargin;
  count_ = 0;
  const std::size_t pixels = image.total();
  points_.reserve(pixels + 1);
  next_.reserve(pixels + 1);
  has_previous_.reserve(pixels + 1);
  none_ = static_cast<std::int32_t>(pixels);
  points_[none_] = EdgePoint{};
  smooth_.reserve(stride_);
  difference_.reserve(stride_);
  for (Room<std::int16_t>* rows : {&gx_, &gy_, &magnitude_}) rows->reserve(std::size_t{3} * stride_);
  maps_.reserve(std::size_t{kMaps} * map_stride_);
  std::fill_n(maps_.data(), std::size_t{kMaps} * map_stride_, -1);
  mask_.reserve(width_);
  columns_.reserve(width_);
  left_over_.reserve(width_ + 1);
  choices_.reserve(width_);
  if (image.channels() == 3) gray_.reserve(std::size_t{5} * width_);
}

void EdgePointFinder::find(const cv::Mat& image, double minimum_contrast, int gap_px) {
  prepare(image);
  reach_ = std::clamp(gap_px + 1, 1, kMaps - 1);
  minimum_ = static_cast<std::int16_t>(std::min(32767.0, std::ceil(minimum_contrast * stepMagnitude())));
  for (int y = 0; y < height_; ++y) {
    gradientRow(image, y);
    if (y > 2 && y < height_ - 1) pointsOfRow(y - 1);
  }
}

/// Row y of the image, the nearest one beyond its borders. Rows of a colour image are converted in order.
const std::uint8_t* EdgePointFinder::grayRow(const cv::Mat& image, int y) {
  const int row = std::clamp(y, 0, height_ - 1);
  return image.channels() == 1 ? image.ptr<std::uint8_t>(row)
                               : gray_.data() + static_cast<std::size_t>(row % 5) * width_;
}

void EdgePointFinder::gradientRow(const cv::Mat& image, int y) {
  if (image.channels() == 3) {
    const int last = std::min(y + 2, height_ - 1);
    for (int row = y == 0 ? 0 : y + 2; row <= last; ++row) {
      kernel_.gray(image.ptr<std::uint8_t>(row), width_,
                   gray_.data() + static_cast<std::size_t>(row % 5) * width_);
    }
  }
  const std::uint8_t* rows[5];
  for (int k = 0; k < 5; ++k) rows[k] = grayRow(image, y + k - 2);
  std::int16_t* smooth = smooth_.data() + kEdgeRowMargin;
  std::int16_t* difference = difference_.data() + kEdgeRowMargin;
  kernel_.columns(rows, width_, smooth, difference);
  for (std::int16_t* row : {smooth, difference}) {
    row[-2] = row[-1] = row[0];
    row[width_] = row[width_ + 1] = row[width_ - 1];
  }
  kernel_.gradient(smooth, difference, width_, ring(gx_, y), ring(gy_, y), ring(magnitude_, y));
}

void EdgePointFinder::pointsOfRow(int y) {
  const std::int16_t* magnitude[3] = {ring(magnitude_, y - 1), ring(magnitude_, y), ring(magnitude_, y + 1)};
  const std::int16_t* gx = ring(gx_, y);
  const std::int16_t* gy = ring(gy_, y);
  const int found = kernel_.maxima(magnitude, gx, gy, 2, width_ - 2, minimum_, mask_.data(), columns_.data());
  // Neighbours across an edge, as distances in memory: of a steep one in its row, of a flat one in the next.
  const std::ptrdiff_t up = ring(gx_, y - 1) - gx;
  const std::ptrdiff_t down = ring(gx_, y + 1) - gx;
  std::int32_t* here = map(y);
  std::fill_n(here, width_, -1);
  // Members are read before: the compiler must take a write of bytes for one to any of them.
  const std::uint16_t* columns = columns_.data();
  EdgePoint* points = points_.data() + count_;
  const int first = count_;
  std::memset(next_.data() + first, 0, found * sizeof(std::int16_t));
  std::memset(has_previous_.data() + first, 0, found);
  // Nothing in this loop depends on chance: the processor never waits for it.
  for (int k = 0; k < found; ++k) {
    const int x = columns[k];
    const int u = gx[x];
    const int v = gy[x];
    const std::ptrdiff_t flat = -static_cast<std::ptrdiff_t>(std::abs(u) < std::abs(v));  // a mask
    const std::ptrdiff_t before_at = x - 1 + (flat & (up + 1));
    const std::ptrdiff_t after_at = x + 1 + (flat & (down - 1));
    // Top of the parabola through what the three gradients have in the direction of the middle one. Each
    // product is at most 2 * 12240^2: the sums fit.
    const int squared = u * u + v * v;
    const int before = u * gx[before_at] + v * gy[before_at];
    const int after = u * gx[after_at] + v * gy[after_at];
    const int curvature = std::max((squared - before) + (squared - after), 1);
    float offset = 0.5F * static_cast<float>(after - before) / static_cast<float>(curvature);
    offset = std::min(std::max(offset, -0.6F), 0.6F);
    EdgePoint& point = points[k];
    const float offsets[2] = {offset, 0.0F};
    point.x = static_cast<float>(x) + offsets[flat & 1];
    point.y = static_cast<float>(y) + offsets[(flat & 1) ^ 1];
    point.gx = static_cast<std::int16_t>(u);
    point.gy = static_cast<std::int16_t>(v);
    point.squared = squared;
    here[x] = first + k;
  }
  linkRow(found, y);
  count_ += found;
}

/// Joins two points, if both are free on that side and of about the same direction.
/// @param onward whether the way with the brighter side on the left goes from `other` to `here`.
bool EdgePointFinder::connect(std::int32_t other, std::int32_t here, bool onward) {
  if (other < 0) return false;
  const std::int32_t from = onward ? other : here;
  const std::int32_t to = onward ? here : other;
  const int step = to - from;
  const EdgePoint& a = points_[from];
  const EdgePoint& b = points_[to];
  const auto dot = static_cast<float>(a.gx * b.gx + a.gy * b.gy);
  const float limit = kMinimumSquaredCos * static_cast<float>(a.squared) * static_cast<float>(b.squared);
  const int refused = static_cast<int>(next_[from]) | static_cast<int>(has_previous_[to]) |
                      static_cast<int>(step != static_cast<std::int16_t>(step)) |
                      static_cast<int>(dot <= 0.0F) | static_cast<int>(dot * dot < limit);
  if (refused != 0) return false;
  next_[from] = static_cast<std::int16_t>(step);
  has_previous_[to] = 1;
  return true;
}

/// Links the points of a row to those found so far: upwards along a steep edge, to the left along a flat one.
/// The nearest to the direction of the edge comes first. Which neighbours exist is beyond prediction, so that
/// the first choice of each point is made without branches, and before any of them is joined: the processor
/// need not wait for a write that a later read may meet.
void EdgePointFinder::linkRow(int found, int y) {
  // Members are read before: the compiler must take a write of bytes for one to any of them.
  const std::int32_t* here = map(y);
  const std::ptrdiff_t up = map(y - 1) - here;
  const std::int32_t none = none_;
  const std::int32_t row = count_;
  const EdgePoint* points = points_.data();
  const std::uint16_t* columns = columns_.data();
  Choice* choices = choices_.data();
  for (int k = 0; k < found; ++k) {
    const std::int32_t* at = here + columns[k];
    const EdgePoint& p = points[row + k];
    const int u = p.gx;
    const int v = p.gy;
    const int flat = -static_cast<int>(std::abs(u) < std::abs(v));  // masks
    const int leans_left = (u ^ v) >> 31;
    // Going up, an edge leans to the side that its gradient turns to. Straight up of a flat point that leans
    // left is a neighbour on its left.
    const int lean = 1 + 2 * leans_left;
    const std::ptrdiff_t first_at = up + (flat & (-1 - up));
    const std::ptrdiff_t second_at = up + lean + (flat & (-1 - lean));
    const std::ptrdiff_t third_at = up - lean + (flat & (lean + ~leans_left));
    const std::int32_t j = either(at[first_at], either(at[second_at], either(at[third_at], none)));
    const EdgePoint& q = points[j];
    const auto dot = static_cast<float>(u * q.gx + v * q.gy);
    const float limit = kMinimumSquaredCos * static_cast<float>(p.squared) * static_cast<float>(q.squared);
    const int alike = static_cast<int>(dot > 0.0F) & static_cast<int>(dot * dot >= limit);
    // A flat edge goes on to the right too; a steep one beside a flat point to the left.
    const int free_right = static_cast<int>(static_cast<std::uint32_t>(at[1]) >> 31);
    const int left = static_cast<int>(static_cast<std::uint32_t>(~at[-1]) >> 31);
    choices[k].other = none ^ ((none ^ j) & -alike);
    // Onwards is from j to i where the gradient of a steep point is to the right, of a flat one up.
    choices[k].back = -static_cast<int>(((flat & (-v ^ u)) ^ u) <= 0);
    choices[k].more = left ^ (flat & (left ^ free_right));
  }
  std::int16_t* next = next_.data();
  std::uint8_t* has_previous = has_previous_.data();
  std::int32_t* left_over = left_over_.data();
  int rest = 0;
  for (int k = 0; k < found; ++k) {
    const std::int32_t i = row + k;
    const std::int32_t j = choices[k].other;
    const std::int32_t swap = (i ^ j) & choices[k].back;
    const std::int32_t from = j ^ swap;
    const std::int32_t to = i ^ swap;
    const int step = to - from;
    const int joined = static_cast<int>((next[from] | has_previous[to]) == 0) & static_cast<int>(j != none) &
                       static_cast<int>(step == static_cast<std::int16_t>(step));
    next[none ^ ((none ^ from) & -joined)] = static_cast<std::int16_t>(step);
    has_previous[none ^ ((none ^ to) & -joined)] = 1;
    left_over[rest] = k << 1 | joined;
    rest += choices[k].more | (joined ^ 1);
  }
  for (int k = 0; k < rest; ++k) {
    const int which = left_over[k] >> 1;
    linkRest(row + which, columns[which], y, (left_over[k] & 1) != 0);
  }
}

/// The less likely links of a point, after the first choice was joined or not.
void EdgePointFinder::linkRest(std::int32_t point, int x, int y, bool joined) {
  const EdgePoint& p = points_[point];
  const std::int32_t* here = map(y) + x;
  const std::int32_t* above = map(y - 1) + x;
  const bool leans_right = (p.gx > 0) == (p.gy > 0);
  if (std::abs(p.gx) >= std::abs(p.gy)) {
    const bool onward = p.gx > 0;
    const int lean = leans_right ? 1 : -1;
    joined = joined || connect(above[lean], point, onward) || connect(above[-lean], point, onward);
    const bool beside = connect(here[-1], point, onward != leans_right);
    if (reach_ > 1 && !joined && (leans_right || !beside)) bridgeSteep(point, x, y);
  } else {
    const bool onward = p.gy < 0;
    joined =
        joined || connect(above[-1], point, onward) || (!leans_right && connect(above[0], point, onward));
    if (reach_ > 1 && !joined) bridgeFlat(point, x, y, -1);
    if (here[1] >= 0) return;
    const bool right =
        connect(above[1], point, !onward) || (leans_right && connect(above[0], point, !onward));
    if (reach_ > 1 && !right && leans_right) bridgeFlat(point, x, y, 1);
  }
}

/// Over missing points: straight on upwards, or one pixel beside.
void EdgePointFinder::bridgeSteep(std::int32_t point, int x, int y) {
  const EdgePoint& p = points_[point];
  const bool onward = p.gx > 0;
  const float slope = static_cast<float>(p.gy) / static_cast<float>(p.gx);
  // A gap in an edge near the diagonal may be wider than high.
  if (connect(map(y - 1)[x + (slope > 0.0F ? 2 : -2)], point, onward)) return;
  for (int k = 2; k <= reach_; ++k) {
    const std::int32_t* row = map(y - k) + x + nearest(slope * static_cast<float>(k));
    if (connect(row[0], point, onward) || connect(row[-1], point, onward) || connect(row[1], point, onward)) {
      return;
    }
  }
}

/// The same to the left (side -1) or right (1), in this row or above.
void EdgePointFinder::bridgeFlat(std::int32_t point, int x, int y, int side) {
  const EdgePoint& p = points_[point];
  const bool onward = (p.gy < 0) == (side < 0);
  const float slope = static_cast<float>(-side) * static_cast<float>(p.gx) / static_cast<float>(p.gy);
  const int lowest = side < 0 ? 0 : -1;  // in this row the one on the right does it
  if (slope < 0.0F && connect(map(y - 2)[x + side], point, onward)) return;
  for (int k = 2; k <= reach_; ++k) {
    const int ahead = nearest(slope * static_cast<float>(k));
    if (ahead > lowest + 1) return;
    for (const int rise : {ahead, ahead + 1, ahead - 1}) {
      if (rise > lowest || rise <= -kMaps) continue;
      if (connect(map(y + rise)[x + side * k], point, onward)) return;
    }
  }
}

}  // namespace vismem
