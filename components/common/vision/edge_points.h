/// @file Sub-pixel edge points of an image, linked along their edges. Pure. SPEC V1.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "common/vision/edge_rows.h"

namespace vismem {

/// Where the gradient is largest across an edge.
struct EdgePoint {
  float x = 0.0F;  ///< sub-pixel [px]
  float y = 0.0F;
  std::int16_t gx = 0;  ///< gradient, see EdgeRowKernel
  std::int16_t gy = 0;
  std::int32_t squared = 0;  ///< length of the gradient, squared
};

/// Room that is taken once for a size of image and never cleared: pages that no frame touches cost nothing.
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

  /// @param image CV_8UC1 or CV_8UC3 (R, G, B), at least 5x5; none of the outer 2 px are edge points.
  /// @param minimum_contrast of an ideal step that is an edge [grey levels].
  /// @param gap_px            so many missing points are jumped, straight on; at most 2.
  void find(const cv::Mat& image, double minimum_contrast, int gap_px);

  /// In raster order.
  int count() const { return count_; }
  /// No image of this size can have more.
  int capacity() const { return width_ * height_; }
  const EdgePoint* points() const { return points_.data(); }
  /// For each point, how much further in the list the one is that follows with the brighter side on the left;
  /// 0 where none does.
  const std::int16_t* next() const { return next_.data(); }
  /// Whether a point follows another one.
  const std::uint8_t* hasPrevious() const { return has_previous_.data(); }

 private:
  static constexpr int kMargin = 8;  // columns beside a row map: what looks sideways needs no test
  static constexpr int kMaps = 4;    // this row and those above it that a gap of 2 px reaches

  /// The point that one would be linked to first.
  struct Choice {
    std::int32_t other;  // none_ if there is none of its direction
    std::int32_t back;   // -1 where the way onwards goes to the other one, else 0
    std::int32_t more;   // whether it may have further links
  };

  void prepare(const cv::Mat& image);
  const std::uint8_t* grayRow(const cv::Mat& image, int y);
  void gradientRow(const cv::Mat& image, int y);
  void pointsOfRow(int y);
  void linkRow(int found, int y);
  void linkRest(std::int32_t point, int x, int y, bool joined);
  void bridgeSteep(std::int32_t point, int x, int y);
  void bridgeFlat(std::int32_t point, int x, int y, int side);
  bool connect(std::int32_t other, std::int32_t here, bool onward);

  std::int16_t* ring(Room<std::int16_t>& rows, int y) { return rows.data() + (y + 3) % 3 * stride_; }
  const std::int16_t* ring(const Room<std::int16_t>& rows, int y) const {
    return rows.data() + (y + 3) % 3 * stride_;
  }
  std::int32_t* map(int y) { return maps_.data() + (y & (kMaps - 1)) * map_stride_ + kMargin; }

  const EdgeRowKernel& kernel_;
  int width_ = 0;
  int height_ = 0;
  std::int16_t minimum_ = 0;
  int reach_ = 1;  // rows or columns that a link may span
  int stride_ = 0;
  int map_stride_ = 0;
  int count_ = 0;
  std::int32_t none_ = 0;  // index of a point without gradient that nothing is like
  Room<EdgePoint> points_;
  Room<std::int16_t> next_;
  Room<std::uint8_t> has_previous_;
  Room<std::uint8_t> gray_;  // five rows of a colour image
  Room<std::int16_t> smooth_, difference_;
  Room<std::int16_t> gx_, gy_, magnitude_;  // three rows each
  Room<std::int32_t> maps_;                 // index of the point at each column, or -1
  Room<std::uint8_t> mask_;
  Room<std::uint16_t> columns_;
  Room<Choice> choices_;
  Room<std::int32_t> left_over_;
};

/// Standard deviation of the image's own noise [grey levels]: from second differences that neither edges nor
/// slopes excite, at their lower quartile, so that texture counts little. A few thousand places all over the
/// image are looked at, whatever its size. 0 for a flat image.
/// @param image CV_8UC1 or CV_8UC3 (R, G, B): there the noise of its brightness.
double estimateNoise(const cv::Mat& image);

/// Length of the gradient in the middle of an ideal step of one grey level.
double stepMagnitude();
/// The same for independent pixel noise of standard deviation 1: the deviation of gx (and of gy).
double noiseMagnitude();

}  // namespace vismem
