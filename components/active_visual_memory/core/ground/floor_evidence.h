/// @file What the image shows where a remembered segment should be. Pure. See M4 (positive evidence).
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/geometry/camera.h"
#include "common/geometry/segment.h"

namespace vismem {

/// Mean colours beside a segment, left and right of a -> b as ImageSegment defines left. Grey images have
/// three equal channels.
struct SideColours {
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
};

/// What the image shows along the place of a remembered edge.
enum class PlaceShows {
  kUnknown,   ///< no image, or too few samples inside it
  kFree,      ///< a surface of the colour of one side and no edge: evidence of absence
  kOccluded,  ///< an edge, or a surface of another colour
};

/// What interrupts an edge.
enum class GapShows {
  kFree,         ///< both sides continue: the edge has a gap
  kStandsThere,  ///< an object whose foot lies at the edge: the floor before the edge is visible
  kOccluded,     ///< an object anywhere before the edge, or no evidence
};

/// Samples strips of one image beside a segment. *Pure*; keeps a header of the image, whose pixels must not
/// change.
class FloorEvidence {
 public:
  struct Params {
    int samples = 10;                  ///< along the segment, over its middle 80 %
    double side_px = 5.0;              ///< distance of the side samples from the segment
    double max_contrast = 10.0;        ///< grey levels across a free place, at most
    double max_contrast_share = 0.35;  ///< of the remembered contrast, at most
    double max_difference = 22.0;      ///< grey levels per channel to the remembered colour of a side
    double free_share = 0.8;           ///< of the samples that must be free
    // An occluder hides both sides of an edge behind its end.
    double beyond_px = 6.0;  ///< distance behind an end, +- 2 px; detectors stop short
    double beside_px = 3.0;  ///< distance beside it, +- 1 px
  };

  FloorEvidence(const cv::Mat& image, const CameraIntrinsics& intrinsics, const Params& params);

  /// Mean colours beside a segment. @return empty without an image or with too few samples inside it.
  std::optional<SideColours> sides(const Segment2& px_ideal) const;
  /// Whether an occluder ends the edge: behind the end neither side continues, on both sides of the line.
  /// Behind a corner or the end of a line marking at least one side continues.
  /// @param at_b which end. @return false also without evidence.
  bool isHiddenBeyond(const Segment2& px_ideal, bool at_b) const;
  /// Difference of the colours to both sides of a place on the line [grey levels], of that many pixels aside.
  /// @return empty outside the image.
  std::optional<double> contrastAt(const Segment2& px_ideal, double fraction, double aside_px) const;
  /// Whether a short piece of a line shows no edge: less than `most_contrast` [grey levels] between points 2
  /// px to both sides of its middle. @return false also without evidence.
  bool isEdgeless(const Segment2& px_ideal, double most_contrast) const;
  /// Classifies a gap. @param from_px its beginning, from end a. @param to_px its end.
  GapShows gap(const Segment2& px_ideal, double from_px, double to_px) const;
  /// Classifies the place of a remembered edge. @param remembered colours beside it.
  PlaceShows classify(const Segment2& px_ideal, const SideColours& remembered) const;

 private:
  /// Of a sample along a segment, from 0 at its end a.
  double fractionOf(int sample) const;
  /// @return false outside the image.
  bool addColour(const Eigen::Vector2d& px_ideal, Eigen::Vector3i& sum) const;
  std::optional<Eigen::Vector3d> colourAt(const Eigen::Vector2d& px_ideal) const;
  /// Mean colour of 3 px across and of `half_length` to both sides along, every 2 px.
  std::optional<Eigen::Vector3d> patchAt(const Eigen::Vector2d& px_ideal, const Eigen::Vector2d& along,
                                         double half_length) const;

  cv::Mat image_;
  int channels_ = 0;  ///< 0: no image, or of another type
  CameraIntrinsics intrinsics_;
  bool distorts_ = false;
  Params params_;
};

}  // namespace vismem
