/// @file Cuts a segment where its label changes: a wall's foot and a door's foot in one line. Pure. See V3.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/segment_labeller.h"

namespace vismem {

struct LabelledPiece {
  Segment2 px_raw;
  Label label = kUnknownLabel;
};

/// @param minimum_px minimum length of a label along the segment [px]; shorter runs are ignored.
/// @return the pieces from a to b without gaps; one piece when at most one label is known along it, with the
/// label of the whole segment.
std::vector<LabelledPiece> splitByLabel(const cv::Mat& image, const Segment2& px_raw, const Palette& palette,
                                        const LabellerParams& params, double minimum_px);

}  // namespace vismem
