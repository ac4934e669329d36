/// @file Real images with annotated segments, in the format of york_urban_half: NAME.jpg (or another ending
/// that OpenCV reads) and NAME_gt.txt with `x1 y1 x2 y2` a line.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct AnnotatedImage {
  std::string name;
  cv::Mat rgb;                      ///< CV_8UC3 (R, G, B), as the file has it
  std::vector<Segment2> annotated;  ///< [px] of that size, centres on integers
};

/// Subtracted from annotated coordinates [px]: clicks are 1-based, and six detectors agree best at this
/// value.
constexpr double kAnnotationShift_px = 0.75;

/// All images of a folder, sorted by name.
/// @param truth where the annotations lie, usually the same folder.
/// @return empty when `images` is no folder or holds no image.
/// @throws std::runtime_error naming an image that cannot be read or has no annotation, or the file and line
/// of an annotation that is not four numbers.
std::vector<AnnotatedImage> loadAnnotated(const std::filesystem::path& images,
                                          const std::filesystem::path& truth,
                                          double shift_px = kAnnotationShift_px);

/// One of them. @throws std::runtime_error as loadAnnotated.
AnnotatedImage loadAnnotatedImage(const std::filesystem::path& image, const std::filesystem::path& truth,
                                  double shift_px = kAnnotationShift_px);

/// Scales an image to a width by area averaging, and its annotation with it: coordinates times new width over
/// old (york_urban_half's README: halved after the shift).
/// @param width <= the image's.
AnnotatedImage atWidth(const AnnotatedImage& image, int width);

}  // namespace vismem
