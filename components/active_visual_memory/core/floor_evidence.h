/// @file What the image shows where a remembered segment should be. Pure. SPEC M4 (positive evidence).
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

enum class PlaceShows {
  kUnknown,    ///< no image, too few samples inside it
  kBare,       ///< the place looks like one of the sides the segment used to have: nothing is there any more
  kSomething,  ///< an edge, or a surface of another colour: the place is covered
};

enum class GapShows {
  kBare,         ///< on both sides there is what is there beside the gap, too: the edge has a gap
  kStandsThere,  ///< another thing whose foot is at the edge: what lies before the edge shows
  kCovered,      ///< another thing that may stand anywhere before the edge, or the image does not tell
};

/// Looks at strips of one image. *Pure*; keeps a header of the image, whose pixels must not change meanwhile.
class FloorEvidence {
 public:
  struct Params {
    int samples = 10;                  ///< along the segment, over its middle 80 %
    double side_px = 5.0;              ///< how far beside the segment the sides are looked at
    double max_contrast = 10.0;        ///< grey levels across a bare place, at most
    double max_contrast_share = 0.35;  ///< of the contrast the segment used to have
    double max_difference = 22.0;      ///< grey levels per channel to the remembered colour of a side
    double bare_share = 0.8;           ///< of the samples
    // What hides the rest of an edge is another thing on both its sides.
    double beyond_px = 6.0;  ///< how far behind an end is looked, +- 2 px; detectors stop short
    double beside_px = 3.0;  ///< and how far beside it, +- 1 px
  };

  FloorEvidence(const cv::Mat& image, const CameraIntrinsics& intrinsics, const Params& params);

  /// @return empty without an image or with too few samples inside it.
  std::optional<SideColours> sides(const Segment2& px_ideal) const;
  /// Does the edge end because something stands before it? Then what lies beyond its end looks like neither
  /// of its sides, to the left and to the right of its line. Beyond a corner or the end of a painted line at
  /// least one of its sides goes on.
  /// @param at_b which end. @return false also when the image does not tell.
  bool isHiddenBeyond(const Segment2& px_ideal, bool at_b) const;
  /// Is there no edge along a short piece of a line? Where its middle has less than `most_contrast` [grey
  /// levels] of brightness between both sides, 2 px from it. @return false also when the image does not tell.
  bool isEdgeless(const Segment2& px_ideal, double most_contrast) const;
  /// What makes a gap in an edge? @param from_px, to_px the gap, from the segment's end a.
  GapShows gap(const Segment2& px_ideal, double from_px, double to_px) const;
  PlaceShows look(const Segment2& px_ideal, const SideColours& remembered) const;

 private:
  struct Profile {
    Eigen::Vector3d left;
    Eigen::Vector3d middle;
    Eigen::Vector3d right;
  };
  std::optional<Eigen::Vector3d> colourAt(const Eigen::Vector2d& px_ideal) const;
  std::optional<Eigen::Vector3d> patchAt(const Eigen::Vector2d& px_ideal, const Eigen::Vector2d& along) const;
  std::optional<Profile> profileAt(const Segment2& px_ideal, double fraction) const;

  cv::Mat image_;
  CameraIntrinsics intrinsics_;
  Params params_;
};

}  // namespace vismem
