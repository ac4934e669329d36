#include "common/vision/edge_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>

namespace vismem {
namespace {

constexpr int kWordBits = 64;
constexpr int kNarrow = 10000;  // columns: any step over two rows fits 16 bits
constexpr int kCacheLine = 64;

/// Histogram of the second differences along x of those along y: weights 1 -2 1 in both directions.
using SecondDifferences = std::array<std::uint16_t, 8 * 256 + 1>;

/// @return the number of places.
int countDifferences(const cv::Mat& image, SecondDifferences& histogram) {
  constexpr int kAlong = 64;  // places in each direction, at most
  constexpr int kDown = 48;
  const int step_x = std::max(2, (image.cols - 2) / kAlong);
  const int step_y = std::max(2, (image.rows - 2) / kDown);
  int total = 0;
  for (int y = 1; y + 1 < image.rows; y += step_y) {
    const std::uint8_t* above = image.ptr<std::uint8_t>(y - 1);
    const std::uint8_t* here = image.ptr<std::uint8_t>(y);
    const std::uint8_t* below = image.ptr<std::uint8_t>(y + 1);
    // Prefetches the next rows: hardware prefetchers do not follow such distances.
    for (int row = y + step_y - 1; row <= std::min(y + step_y + 1, image.rows - 1); ++row) {
      const std::uint8_t* later = image.ptr<std::uint8_t>(row);
      for (int i = 0; i < image.cols; i += kCacheLine) __builtin_prefetch(later + i);
    }
    for (int x = 1; x + 1 < image.cols; x += step_x) {
      const auto column = [&](int at) { return above[at] - 2 * here[at] + below[at]; };
      ++histogram[std::abs(column(x - 1) - 2 * column(x) + column(x + 1))];
      ++total;
    }
  }
  return total;
}

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
  constexpr double kDeviation = 6.0;         // of a second difference along y of those along x
  constexpr double kLowerQuartile = 0.3186;  // of |x| for a normal x of deviation 1
  if (image.cols < 3 || image.rows < 3) return 0.0;
  SecondDifferences histogram{};
  const int total = countDifferences(image, histogram);
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
  const int block_bits = kWordBits * kernel_.word_block;
  words_ = (width_ + block_bits - 1) / block_bits * kernel_.word_block;
  count_ = 0;
  std::fill_n(found_, kRows, 0);
  stride_ = kWordBits * words_ + 2 * kEdgeReadMargin;
  const std::size_t pixels = image.total() + 2 * kEdgePointBlock;
  points_.reserve(pixels);
  row_begins_.reserve(height_ + 1);
  next_.reserve(pixels);
  previous_.reserve(pixels);
  smooth_.reserve(width_ + 2 * kEdgeRowMargin);
  difference_.reserve(width_ + 2 * kEdgeRowMargin);
  gradient_.reserve(std::size_t{6} * stride_);
  magnitude_.reserve(std::size_t{3} * stride_);
  kind_.reserve(std::size_t{3} * stride_);
  maps_.reserve(std::size_t{kRows} * stride_);
  mask_.reserve(std::size_t{kWordBits} * words_);
  std::memset(mask_.data(), 0, std::size_t{kWordBits} * words_);
  columns_.reserve(stride_);
  packed_.reserve(std::size_t{4} * stride_);
  layPlanes();
}

/// Planes of bits with margins of zeros: rows above the first one have no points.
void EdgePointFinder::layPlanes() {
  constexpr int kPlanes = 7 * kRows + 4 + std::size(EdgeWork{}.plane);
  const int stride = words_ + 2 * kEdgeWordMargin;
  planes_.reserve(static_cast<std::size_t>(kPlanes) * stride);
  std::memset(planes_.data(), 0, static_cast<std::size_t>(kPlanes) * stride * sizeof(std::uint64_t));
  std::uint64_t* plane = planes_.data() + kEdgeWordMargin;
  const auto lay = [&](std::uint64_t*& to) {
    to = plane;
    plane += stride;
  };
  for (EdgeBits& row : bits_) {
    for (std::uint64_t** to :
         {&row.edge, &row.steep, &row.right, &row.down, &row.diagonal, &row.free_next, &row.free_previous}) {
      lay(*to);
    }
  }
  for (std::uint64_t** to : {&links_.left, &links_.above_left, &links_.above, &links_.above_right}) lay(*to);
  for (std::uint64_t*& to : work_.plane) lay(to);
}

void EdgePointFinder::find(const cv::Mat& image, double minimum_contrast, bool bridge) {
  prepare(image);
  bridge_ = bridge;
  minimum_ = static_cast<std::int16_t>(std::min(32767.0, std::ceil(minimum_contrast * stepMagnitude())));
  for (int y = 0; y < height_; ++y) {
    gradientRow(image, y);
    if (y > 2 && y < height_ - 1) pointsOfRow(y - 1);
  }
  std::fill_n(row_begins_.data(), 2, 0);
  std::fill(row_begins_.data() + height_ - 2, row_begins_.data() + height_ + 1, count_);
}

void EdgePointFinder::gradientRow(const cv::Mat& image, int y) {
  const std::uint8_t* rows[5];  // beyond the borders the nearest one
  for (int k = 0; k < 5; ++k) rows[k] = image.ptr<std::uint8_t>(std::clamp(y + k - 2, 0, height_ - 1));
  std::int16_t* smooth = smooth_.data() + kEdgeRowMargin;
  std::int16_t* difference = difference_.data() + kEdgeRowMargin;
  kernel_.columns(rows, width_, smooth, difference);
  for (std::int16_t* row : {smooth, difference}) {
    row[-2] = row[-1] = row[0];
    row[width_] = row[width_ + 1] = row[width_ - 1];
  }
  kernel_.gradient(smooth, difference, width_, ring(gradient_, y, 2), ring(magnitude_, y, 1),
                   ring(kind_, y, 1));
}

void EdgePointFinder::pointsOfRow(int y) {
  const std::int16_t* magnitude[3];
  const std::int16_t* gradient[3];
  for (int k = 0; k < 3; ++k) {
    magnitude[k] = ring(magnitude_, y + k - 1, 1);
    gradient[k] = ring(gradient_, y + k - 1, 2);
  }
  row_begins_[y] = count_;
  EdgeBits& here = bits(y);
  kernel_.maxima(magnitude, ring(kind_, y, 1), 2, width_ - 2, minimum_, mask_.data(), words_, here);
  std::copy_n(here.edge, words_, here.free_next);
  std::copy_n(here.edge, words_, here.free_previous);
  std::uint16_t* columns = columns_.data();
  const int found = kernel_.list(here.edge, words_, count_, columns, map(y));
  std::fill_n(columns + found, kEdgePointBlock, std::uint16_t{2});
  kernel_.points(gradient, {here, words_, columns, found, y, packed_.data()}, points_.data() + count_);
  std::memset(next_.data() + count_, 0, found * sizeof(std::int16_t));
  std::memset(previous_.data() + count_, 0, found);
  count_ += found;
  found_[y & (kRows - 1)] = found;
  if (found > 0) {
    kernel_.link(here, bits(y - 1), words_, work_, links_);
    join(y, y - 1, 1);
  }
  if (!bridge_) return;
  // Flat edges a row later: a neighbour in the row below comes before one beyond a gap.
  if (found_[(y - 1) & (kRows - 1)] > 0 &&
      kernel_.bridge_flat(bits(y - 1), bits(y - 2), words_, work_, links_)) {
    join(y - 1, y - 2, 2);
  }
  if (found == 0) return;
  if (kernel_.bridge_steep(here, bits(y - 2), words_, work_, links_)) join(y, y - 2, 1);
  if (kernel_.bridge_diagonal(here, bits(y - 2), words_, work_, links_)) join(y, y - 2, 2);
}

/// Turns bits into links between points of row y and those to the left or in the row `above`, so many columns
/// aside.
void EdgePointFinder::join(int y, int above, int aside) {
  const EdgeColumns columns{map(y), map(above), aside};
  std::int32_t* from = packed_.data();
  std::int32_t* to = from + 2 * static_cast<std::ptrdiff_t>(stride_);
  const int found = kernel_.list_links(bits(y), links_, words_, columns, from, to);
  std::int16_t* next = next_.data();
  std::uint8_t* previous = previous_.data();
  for (int k = 0; k < found; ++k) {
    const std::int32_t way = to[k] - from[k];
    const auto step = static_cast<std::int16_t>(way);
    if (step != way) continue;
    next[from[k]] = step;
    previous[to[k]] = static_cast<std::uint8_t>(kEarlier + (way < 0 ? 1 : 0));
  }
}

}  // namespace vismem
