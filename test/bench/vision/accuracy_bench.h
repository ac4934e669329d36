/// @file Accuracy of all detectors: on annotated photographs, between two views, on exact edges, on noise.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/vision/detectors.h"
#include "evaluation/app/annotated_images.h"
#include "evaluation/core/segment_accuracy.h"
#include "vision/support/repeatability.h"

namespace vismem {

/// One detector on the photographs at one size.
struct PhotographRow {
  std::string detector;
  std::vector<ImageScore> images;
  AccuracySummary all;
  AccuracySummary even;  ///< the images at even places in the order of names
  AccuracySummary odd;
  Repeatability repeatability;
};

/// Default detector minus a published one, with the 95 % bootstrap interval of 2000 resamplings of the images
/// (with replacement, the same images for both).
struct Difference {
  std::string measure;  ///< "F1", "F2", "F5", "sF5"
  std::string peer;     ///< the best one on all images at that measure
  double ours = 0.0;
  double theirs = 0.0;
  double low = 0.0;
  double high = 0.0;
};

struct PhotographTable {
  std::string size;
  int images = 0;
  std::vector<std::string> names;  ///< of the images
  std::vector<PhotographRow> rows;
  std::vector<Difference> differences;
};

/// Images at widths 320 and 640, each where all photographs are that wide.
std::vector<PhotographTable> measurePhotographs(const std::vector<AnnotatedImage>& images,
                                                const std::vector<DetectorEntry>& detectors,
                                                const std::function<void(int done, int all)>& progress);

struct ExactRow {
  std::string detector;
  double f1_at_noise_3 = 0.0;  ///< F at 1 px
  double rms_px_at_noise_3 = 0.0;
  double f1_at_noise_10 = 0.0;
  double rms_px_at_noise_10 = 0.0;
  double false_segments[3] = {0.0, 0.0, 0.0};  ///< per 320x240 image of noise with sigma 5, 15, 40
};
std::vector<ExactRow> measureExact(const std::vector<DetectorEntry>& detectors, int scenes,
                                   const std::function<void(int done, int all)>& progress);

/// F of one image set by its measure's name; what a Difference compares.
double measureOf(const AccuracySummary& summary, const std::string& measure);

}  // namespace vismem
