/// @file The colour label of a segment. Pure. Implements V3.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/palette.h"

namespace vismem {

struct LabellerParams {
  /// Distances from the segment at which each side is sampled [px], at most 16. The near ones reach stripes
  /// that are only a few pixels wide, the far ones lie beyond a blurred edge. Paint is brighter than its
  /// surroundings, so only the brighter side is sampled very near: the darker side is a mixture there.
  std::vector<double> bright_distances_px{1.0, 1.5, 2.5, 3.5};
  std::vector<double> dark_distances_px{1.5, 2.5, 3.5};
  int samples = 9;                ///< along the segment, at each distance
  double trim = 0.1;              ///< share of the length left out at each end, because of corners
  double minimum_majority = 0.6;  ///< share of the samples of a side that must have one class
  /// Without such a class the mean colour decides, if the samples are of one surface: the largest standard
  /// deviation of a channel [grey levels]. Noise of cameras lies below it, steps between materials above.
  double maximum_scatter = 20.0;
};

/// Colour classes on both sides of a segment, and its label.
struct SegmentSides {
  ColorClass bright = kNoColorClass;  ///< left of a -> b as seen on the screen
  ColorClass dark = kNoColorClass;
  Label label = kUnknownLabel;
};

/// Colour classes beside a segment at equal steps along it, at all distances: any window of them has a label.
/// The class of a side at a distance is that of most samples there, or of their mean colour. The label is
/// that of the nearest pair of distances whose classes are a named pair; without one, each side has the class
/// of its nearest distance with one. *Single-threaded*; keeps its memory for the next segment.
class SideSamples {
 public:
  /// @param palette must outlive it.
  /// @throws std::invalid_argument for more than 16 distances on a side.
  SideSamples(const Palette& palette, LabellerParams params);

  /// Samples a segment, in place of the one before.
  /// @param image    CV_8UC3, order R, G, B; a gray image gives kUnknownLabel.
  /// @param px_raw   raw pixels, brighter side on the left. Samples outside the image do not count.
  /// @param first_px of the first sample from px_raw.a; the next ones follow at step_px.
  void take(const cv::Mat& image, const Segment2& px_raw, double first_px, double step_px, int count);
  /// Samples the whole segment, by LabellerParams::samples and trim.
  void takeWhole(const cv::Mat& image, const Segment2& px_raw);
  /// The same, and its label, which lives as long as the palette.
  const Label& labelOfWhole(const cv::Mat& image, const Segment2& px_raw) {
    takeWhole(image, px_raw);
    return label(0, params_.samples);
  }

  /// Samples first..first + count - 1, all of them among those that were taken.
  SegmentSides sides(int first, int count) const;
  /// Its label alone, which lives as long as the palette.
  const Label& label(int first, int count) const;
  /// Whether the samples first..first + count - 1 certainly have the label of those that begin one earlier:
  /// at each distance all of them have one class. @param first > 0.
  bool asBefore(int first, int count) const;

 private:
  struct Found;
  /// @param at  index of the first of `count` samples.
  void sample(const cv::Mat& image, const Eigen::Vector2d& first, const Eigen::Vector2d& step, int count,
              std::size_t at);
  /// The majority class of samples at a distance; without one that of their mean colour; else kNoColorClass.
  ColorClass classAt(std::size_t distance, int first, int count) const;
  /// @param inside  samples inside the image, > 0.
  ColorClass meanClass(std::size_t at, int count, int inside) const;
  Found look(int first, int count) const;

  const Palette* palette_;
  LabellerParams params_;
  int count_ = 0;  ///< along the segment; 0: there is nothing to sample
  /// By distance, the bright side first, then along the segment: a class, or kOutside.
  std::vector<std::int16_t> classes_;
  std::vector<std::array<std::uint8_t, 3>> colours_;  ///< of the same samples
};

}  // namespace vismem
