/// @file Edges between colours of nearly equal brightness, which the gray picture hides. Pure. SPEC V1, V3.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/vision/segment_detector.h"

namespace vismem {

/// The largest of each pixel's channels: a strong red or blue is bright there, beside a dark floor, too.
/// @param rgb CV_8UC3. @param plane becomes CV_8UC1 of its size.
void strongestChannel(const cv::Mat& rgb, cv::Mat& plane);

/// Joins to `segments`, found in the gray picture, what was found in the plane of the strongest channel and
/// is not there yet, or only in pieces, which it replaces. Polarity and strength stay those of the gray
/// picture. @param image CV_8UC3.
void joinColourEdges(const cv::Mat& image, const std::vector<RawSegment>& found_in_plane,
                     std::vector<RawSegment>& segments);

}  // namespace vismem
