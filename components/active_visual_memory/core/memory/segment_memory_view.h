/// @file One image and its associations with the memory. Internal to SegmentMemory.
#pragma once

#include <vector>

#include "active_visual_memory/core/memory/segment_memory.h"

namespace vismem {

// Expectation and absence.
inline constexpr double kMinVisible_px = 10.0;  // shorter visible parts are not expected to be observed
inline constexpr double kViewMargin_px = 4.0;  // expectations nearer to the border are no evidence of absence
inline constexpr double kMaxMappingTurn_radps =
    3.0;  // turn rate of the camera up to which new elements are added
inline constexpr double kRangeSlack =
    1.03;  // segments that a frame tilt moved beyond this times the range are cut again
// An absence with less than this share of the full life contradicts that an edge rests: the detector misses
// edges for two or three images, and those long unseen are less sure.
inline constexpr double kContradictedShare = 0.8;
// Gates on the floor (M3; M2 multiplies them by kDuplicateGateShare).
inline constexpr double kNearAngle_rad = 0.12;
inline constexpr double kMaxGap_m = 0.06;          // between the extents of pieces of one line
inline constexpr double kFarDistanceShare = 0.02;  // added to the near distance per metre from the camera
inline constexpr double kSlackShare = 0.003;       // added to the slack of a match per metre from the camera
inline constexpr double kGateSigmas = 3.0;
inline constexpr double kLabelShare = 0.4;  // of the votes that a label needs
// Residuals of the filter.
inline constexpr double kCorrelationInflation =
    2.0;  // factor of sigmas: errors of successive images are correlated
// Factor of the sigmas of ends along their line. The detector ends short by a pixel in every image: as
// independent errors that would bias the tilt of an approaching camera and the scale of its way.
inline constexpr double kEndInflation = 16.0;
inline constexpr std::size_t kResidualsPerPiece = 4;  // of both ends, across and along
inline constexpr double kMaxEndShift_m = 0.15;        // ends further apart are not compared
// Ends and gaps.
// Images that must see an end further in, with free floor or an edge of another label behind it.
inline constexpr int kShortVotes = 6;
inline constexpr double kGapContrastShare = 0.35;  // of the contrast of the line: less in the gap is no edge
inline constexpr double kGapPlace_m = 0.05;        // distance within which votes are for one gap
// M10.
inline constexpr double kNew_s = 8.0;              // age up to which an element is new
inline constexpr double kWellKnown_s = 40.0;       // an element is well known if seen within this time ..
inline constexpr double kWellKnownTravel_m = 3.0;  // .. and this way

struct SegmentMemory::View {
  const RobotObservation& observation;
  Pose3 T_odom_camera;
  Eigen::Vector2d camera;  ///< the floor point below the camera [m]
  double height;
  double turn_rate;
  FloorEvidence evidence;
  Eigen::Matrix2d P_frame_tilt = Eigen::Matrix2d::Zero();  ///< of this image [rad^2]

  /// From the floor point below the camera [m].
  double distanceTo(const FloorSegment& segment) const { return (segment.odom().middle() - camera).norm(); }
};

/// Which observed segments belong to which remembered ones.
struct SegmentMemory::Associations {
  explicit Associations(std::pmr::memory_resource* scratch)
      : expected(scratch), index_of(scratch), seen(scratch), used(scratch), matches(scratch) {}

  std::pmr::vector<Expectation> expected;
  std::pmr::vector<int> index_of;                                ///< of the element, per expectation
  std::pmr::vector<std::pmr::vector<const FloorSegment*>> seen;  ///< matched and supporting, per expectation
  std::pmr::vector<bool> used;                                   ///< per observed segment
  std::pmr::vector<ImageAnalysis::Match> matches;                ///< one-to-one
};

}  // namespace vismem
