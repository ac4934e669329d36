/// @file Straight segments of one image. Implements V1, V2. Pure: the result depends on the image only.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// A segment as detected. Invariant: finite ends inside the image, length > 0; the brighter side lies to the
/// left of a -> b (see ImageSegment).
struct RawSegment {
  Segment2 px_raw;        ///< raw (distorted) pixels, sub-pixel, centres on integers
  double strength = 0.0;  ///< mean difference of brightness across the segment [grey levels, 0..255]
};

/// *Single-threaded*: an object may keep work space, but no data of earlier images.
class SegmentDetector {
 public:
  virtual ~SegmentDetector() = default;
  /// @param image CV_8UC1, or CV_8UC3 in the order R, G, B; any size from 16x16 on (smaller: no segments).
  /// @param out   replaced by the segments found, in an order that depends on the image only.
  /// @throws std::invalid_argument for another pixel type.
  virtual void detect(const cv::Mat& image, std::vector<RawSegment>& out) = 0;
};

/// The default detector: edge points at the largest gradient across the edge, linked along the edge. Runs of
/// equal direction become lines by sub-pixel total least squares.
struct SolisParams {
  double minimum_length_px = 9.0;
  /// Minimum of length squared times strength [px^2 grey levels]: a short segment must be strong, a faint one
  /// long.
  double minimum_significance = 2800.0;
  /// Minimum of strength times the root of length over the image noise [px^0.5]: certainty of the line's
  /// position.
  double minimum_certainty = 17.0;
  /// Minimum contrast of edge points in multiples of the image noise, and at least `minimum_contrast`.
  double noise_factor = 3.2;
  double minimum_contrast = 9.0;     ///< [grey levels] of an ideal step
  bool bridge_missing_point = true;  ///< chains continue over one missing point
  int first_fit_points = 7;          ///< a run begins with this many points in line
  double first_fit_rms_px = 0.4;
  double line_tolerance_px = 0.7;  ///< a point further than this from the run's line breaks it
  int maximum_strays = 2;          ///< number of consecutive outliers that do not break a run
  double maximum_rms_px = 0.6;     ///< of the points of a run about its line
  double piece_length_px = 6.0;    ///< shorter runs are left out before merging
  double alignment_cos = 0.95;     ///< a point agrees with its line if its gradient is this near the normal
  double alignment_share = 0.7;    ///< share of the points that must agree
  double maximum_shift_px = 0.15;  ///< maximum lateral correction by the brightness profile
  double merge_angle_rad = 0.1;    ///< collinear pieces: direction
  double merge_offset_px = 1.8;    ///< collinear pieces: normal distance of the shorter one's ends
  double merge_gap_px = 4.0;       ///< collinear pieces: distance of the near ends along the line
  /// A longer gap, up to bridge_share times the shorter piece and bridge_px, is closed if its brightness step
  /// is at least bridge_step_share of the weaker piece's step.
  double bridge_share = 1.0;
  double bridge_px = 20.0;
  double bridge_step_share = 0.75;
};

/// The published Solis flow (mode `chapter`): normalise, smooth 3x3, Laplace, threshold, contours, chords
/// classified by direction, runs of equal direction.
struct ChapterSolisParams {
  int laplace_kernel = 3;
  double threshold = 30.0;          ///< on the absolute Laplacian [grey levels]
  int minimum_contour_px = 30;      ///< shorter contours are left out
  int chord_px = 6;                 ///< contour pixels per chord
  int minimum_fragments = 3;        ///< chords of one direction that make a segment
  int merge_index_gap = 3;          ///< consecutive segments of one contour: chords from end to begin
  double merge_distance_px = 18.0;  ///< and the distance between their ends
};

/// Canny and probabilistic Hough transform (V2).
struct HoughParams {
  double canny_low = 50.0;
  double canny_high = 150.0;
  int votes = 30;
  double minimum_length_px = 20.0;
  double maximum_gap_px = 3.0;
};

std::unique_ptr<SegmentDetector> makeSolisDetector(const SolisParams& params = {});
std::unique_ptr<SegmentDetector> makeChapterDetector(const ChapterSolisParams& params = {});
std::unique_ptr<SegmentDetector> makeHoughDetector(const HoughParams& params = {});

/// "solis", "chapter", "hough".
const std::vector<std::string>& segmentDetectorNames();
/// A detector with its default parameters.
/// @throws ConfigError for an unknown name, with the known ones.
std::unique_ptr<SegmentDetector> makeSegmentDetector(std::string_view name);

}  // namespace vismem
