/// @file The light under which a camera sees the colours of a palette. Pure. See V3.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/light.h"
#include "common/vision/palette.h"
#include "common/vision/segment_detector.h"

namespace vismem {

/// Searches the light under which the palette names most of the edges of the last images, weighted by their
/// squared length: long edges are structure, short ones may be texture. Pairs of colours are rare among all
/// pairs, so a wrong light names few of them. The neutral light ends when another one names twice as many
/// edges; while it names an eighth of all, the other one must also give these edges other names.
/// *Single-threaded*, deterministic.
class LightEstimator {
 public:
  /// @param palette not null.
  explicit LightEstimator(std::shared_ptr<const Palette> palette);

  /// Learns from one image.
  /// @param image    as the camera gave it; only CV_8UC3 (R, G, B) says anything.
  /// @param segments detected in it, raw pixels, brighter side on the left.
  /// @return whether the light changed.
  bool update(const cv::Mat& image, const std::vector<RawSegment>& segments);

  const ImageLight& light() const { return light_; }
  /// Share of the last edges that have a name under this light, by squared length, 0..1; 1 before any edge.
  double namedShare() const { return named_share_; }

 private:
  /// Colours beside one edge.
  struct Sample {
    std::array<std::array<std::uint8_t, 3>, 2> sides;
    std::uint8_t ring = 0;  ///< LightTable::ring of its middle
    double weight = 0.0;    ///< squared length [px^2]
    bool named = false;     ///< under the present light
  };
  /// Common gain, red and blue against green (logarithms), logarithm of gamma, vignette.
  using Unknowns = Eigen::Matrix<double, 5, 1>;

  static constexpr int kNoName = -1;

  static ImageLight lightOf(const Unknowns& x);
  void add(const cv::Mat& image, const Segment2& px);
  int nameUnder(const LightTable& table, const Sample& sample) const;
  /// Share of the samples that `is_named` holds for, by weight; 1 without samples.
  template <typename IsNamed>
  double shareOf(const IsNamed& is_named) const;
  double shareUnder(const ImageLight& light) const;
  /// Whether a light gives other names to edges that the neutral one names.
  bool renames(const ImageLight& light) const;
  bool endsNeutral(const ImageLight& light, double neutral, double other) const;
  /// The share less the prior's cost of a light far from the neutral one.
  double merit(const Unknowns& x) const;
  Unknowns coarsest() const;
  Unknowns climbed(Unknowns x) const;
  Unknowns centred(Unknowns x) const;
  bool search();

  std::shared_ptr<const Palette> palette_;
  std::vector<int> names_;         // of pairs of classes: indices of the palette's labels, or kNoName
  std::vector<Segment2> longest_;  // work space: of the last image, longest first
  std::vector<Sample> samples_;    // a ring
  std::size_t next_ = 0;
  std::size_t unsearched_ = 0;  // samples since the last search
  std::size_t patience_;        // samples until the next one
  Unknowns x_ = Unknowns::Zero();
  ImageLight light_;
  LightTable table_{light_};
  double named_share_ = 1.0;
  double searched_share_ = 1.0;  // at the last search
};

}  // namespace vismem
