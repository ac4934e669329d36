/// @file Sub-pixel edge points of an image, linked along their edges. Pure. See V1.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "common/vision/edge_rows.h"

namespace vismem {

/// Memory that is allocated once per image size and never cleared: untouched pages need no memory.
template <typename T>
class Room {
 public:
  void reserve(std::size_t count) {
    if (count <= count_) return;
    data_ = std::make_unique_for_overwrite<T[]>(count);
    count_ = count;
  }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  std::unique_ptr<T[]> data_;
  std::size_t count_ = 0;
};

/// Finds and links the edge points of an image in one pass from top to bottom. Keeps its work space.
class EdgePointFinder {
 public:
  explicit EdgePointFinder(const EdgeRowKernel& kernel) : kernel_(kernel) {}

  /// @param image CV_8UC1, at least 5x5; none of the outer 2 px are edge points.
  /// @param minimum_contrast of an ideal step that is an edge [grey levels].
  /// @param bridge whether a single missing point is bridged.
  void find(const cv::Mat& image, double minimum_contrast, bool bridge);

  /// In raster order.
  int count() const { return count_; }
  /// Largest number of points in an image of this size.
  int capacity() const { return width_ * height_; }
  const EdgePoint* points() const { return points_.data(); }
  /// For each row of the image, the first point that lies in it or in a later one.
  const std::int32_t* rowBegins() const { return row_begins_.data(); }
  /// For each point, the distance in the list to its successor, with the brighter side on the left. 0 without
  /// a successor, or beyond the type's range, which takes rows of more than 10 000 points.
  const std::int16_t* next() const { return next_.data(); }
  /// For each point, the position of its predecessor in the list.
  const std::uint8_t* previous() const { return previous_.data(); }
  /// Lists the starts of chains of two or more points, and of possible rings: points that lie before both
  /// neighbours in the list, as the first point of every ring does. In raster order.
  /// @param starts, tops room for all points and a block more.
  EdgeChainEnds listStarts(std::int32_t* starts, std::int32_t* tops) const {
    return kernel_.starts(next_.data(), previous_.data(), count_, starts, tops);
  }

 private:
  static constexpr int kRows = 4;  // a power of two: this row and the two above it that a bridge reaches

  void prepare(const cv::Mat& image);
  void layPlanes();
  void gradientRow(const cv::Mat& image, int y);
  void pointsOfRow(int y);
  void join(int y, int above, int aside);

  /// Rows of so many values a pixel.
  std::int16_t* ring(Room<std::int16_t>& rows, int y, int values) {
    return rows.data() + values * (static_cast<std::ptrdiff_t>(y % 3) * stride_ + kEdgeReadMargin);
  }
  EdgeBits& bits(int y) { return bits_[y & (kRows - 1)]; }
  std::int32_t* map(int y) {
    return maps_.data() + static_cast<std::ptrdiff_t>(y & (kRows - 1)) * stride_ + kEdgeReadMargin;
  }

  const EdgeRowKernel& kernel_;
  int width_ = 0;
  int height_ = 0;
  int words_ = 0;   // of a plane
  int stride_ = 0;  // of rows that are read by blocks
  std::int16_t minimum_ = 0;
  int count_ = 0;
  bool bridge_ = false;
  Room<EdgePoint> points_;
  Room<std::int32_t> row_begins_;
  Room<std::int16_t> next_;
  Room<std::uint8_t> previous_;
  Room<std::int16_t> smooth_, difference_;
  Room<std::int16_t> gradient_, magnitude_, kind_;  // three rows each
  Room<std::int32_t> maps_;                         // index of the point at each column, where there is one
  Room<std::uint8_t> mask_;
  Room<std::uint16_t> columns_;
  Room<std::int32_t> packed_;
  Room<std::uint64_t> planes_;
  EdgeBits bits_[kRows];
  int found_[kRows] = {};  // points of the last rows
  EdgeLinks links_;
  EdgeWork work_;
};

/// Standard deviation of the image noise [grey levels]: from the lower quartile of second differences, which
/// are insensitive to edges and slopes and little sensitive to texture. Samples a few thousand places of the
/// image. 0 for a uniform image.
/// @param image CV_8UC1.
double estimateNoise(const cv::Mat& image);

/// Length of the gradient in the middle of an ideal step of one grey level.
double stepMagnitude();
/// The same for independent pixel noise of standard deviation 1: the deviation of gx (and of gy).
double noiseMagnitude();

}  // namespace vismem
