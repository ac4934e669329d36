/// @file From an image to its labelled segments. Pure. See V1-V4.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/profiling/stage_probe.h"
#include "common/vision/colour_edges.h"
#include "common/vision/image_segment.h"
#include "common/vision/label_split.h"
#include "common/vision/palette.h"
#include "common/vision/segment_detector.h"
#include "common/vision/segment_labeller.h"
#include "common/vision/segment_merge.h"

namespace vismem {

struct ExtractorParams {
  std::string detector = "solis";   ///< see makeSegmentDetector
  MergeParams merge;                ///< V4
  double minimum_length_px = 10.0;  ///< shorter segments are dropped after merging (V4)
  LabellerParams labeller;
  bool colour_edges = false;  ///< also edges between colours of equal brightness
};

/// *Single-threaded*; keeps no data of earlier images.
class SegmentExtractor {
 public:
  /// @param palette may be null: every label is kUnknownLabel then.
  /// @throws ConfigError for an unknown detector.
  SegmentExtractor(ExtractorParams params, std::shared_ptr<const Palette> palette);
  ~SegmentExtractor();
  SegmentExtractor(SegmentExtractor&&) noexcept;
  SegmentExtractor& operator=(SegmentExtractor&&) noexcept;

  /// Detects, labels, undistorts the ends, merges and drops short ones.
  /// @param image      CV_8UC3 (R, G, B) or CV_8UC1, raw pixels.
  /// @param intrinsics of that image; its distortion is removed from the ends.
  /// @throws std::invalid_argument when the image's size is not the intrinsics' or its type is another.
  /// @param probe called at the stages "detect" and "label"; may be null.
  /// @return until the next call.
  const std::vector<ImageSegment>& extract(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                           StageProbe* probe = nullptr);
  /// The segments of `extract` before merging and dropping: detected, labelled, ends undistorted (figure 10,
  /// left).
  /// @return until the next call.
  const std::vector<ImageSegment>& extractPieces(const cv::Mat& image, const CameraIntrinsics& intrinsics,
                                                 StageProbe* probe = nullptr);

  /// All segments that were detected in the last image.
  const std::vector<RawSegment>& detected() const { return raw_; }
  /// From the next image on. @param length_px >= 0.
  void setMinimumLength(double length_px) { params_.minimum_length_px = length_px; }

 private:
  ExtractorParams params_;
  std::shared_ptr<const Palette> palette_;
  std::unique_ptr<SegmentDetector> detector_;
  std::vector<RawSegment> raw_;
  cv::Mat plane_;
  std::vector<RawSegment> in_plane_;
  ColourEdgeJoiner joiner_;
  std::optional<LabelSplitter> splitter_;  // with a palette
  SegmentMerger merger_;
  std::vector<ImageSegment> segments_;
};

}  // namespace vismem
