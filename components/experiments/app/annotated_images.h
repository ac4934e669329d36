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

/// Clicks are 1-based; six independent detectors all fit best when this is subtracted [px].
constexpr double kAnnotationShift_px = 0.75;

/// All images of a folder, sorted by name.
/// @param truth where the annotations lie, usually the same folder.
/// @return empty when `images` is no folder or holds no image.
/// @throws std::runtime_error naming an image that cannot be read, has no annotation, or an annotation that
/// is no
///         list of numbers in fours (file and line).
std::vector<AnnotatedImage> loadAnnotated(const std::filesystem::path& images,
                                          const std::filesystem::path& truth,
                                          double shift_px = kAnnotationShift_px);

/// One of them. @throws std::runtime_error as loadAnnotated.
AnnotatedImage loadAnnotatedImage(const std::filesystem::path& image, const std::filesystem::path& truth,
                                  double shift_px = kAnnotationShift_px);

/// The image brought to a width by area averaging, its height in proportion, and the annotation with it: its
/// coordinates times new width over old (york_urban_half's README: halved after the shift).
/// @param width <= the image's.
AnnotatedImage atWidth(const AnnotatedImage& image, int width);

}  // namespace vismem
