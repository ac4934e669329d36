/// @file Cuts a segment where its label changes: a wall's foot and a door's foot in one line. Pure. See V3.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "common/vision/segment_labeller.h"

namespace vismem {

struct LabelledPiece {
  Segment2 px_raw;
  const Label* label;  ///< lives as long as the palette
};

/// *Single-threaded*; keeps its memory for the next segment.
class LabelSplitter {
 public:
  /// @param palette must outlive it.
  /// @throws std::invalid_argument as SideSamples.
  LabelSplitter(const Palette& palette, LabellerParams params);

  /// @param minimum_px minimum length of a label along the segment [px]; shorter runs are ignored.
  /// @return the pieces from a to b without gaps, until the next call; one piece when at most one label is
  /// known along it, with the label of the whole segment.
  std::span<const LabelledPiece> split(const cv::Mat& image, const Segment2& px_raw, double minimum_px);

 private:
  /// An interval of one known label, in pixels from end a.
  struct Run {
    const Label* label;
    double from_px;
    double to_px;
  };

  /// Sets `runs_` to the labels along the segment, neighbours different, without those that are too short.
  void findRuns(const cv::Mat& image, const Segment2& px, double minimum_px);

  SideSamples samples_;
  std::vector<Run> runs_;
  std::vector<LabelledPiece> pieces_;
};

}  // namespace vismem
