/// @file Times of all detectors on the same images, under Google Benchmark.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/vision/detectors.h"
#include "evaluation/app/annotated_images.h"

namespace vismem {

struct SpeedRow {
  std::string detector;
  double ms = 0.0;        ///< mean over images of the median over runs, CPU time of the thread
  double worst_ms = 0.0;  ///< of the slowest image
  double segments = 0.0;  ///< per image
};

struct SpeedTable {
  std::string size;  ///< "320x240"
  int images = 0;
  int runs = 0;  ///< of each image and detector (a third of it for slow detectors)
  std::vector<SpeedRow> rows;

  /// 0 when that detector was not timed.
  double msOf(const std::string& detector) const;
};

/// Gray images at widths 320 and 640 (where the photographs are that wide), and 1920x1080 mosaics of their
/// native pixels. Runs of the detectors are in random order, so that disturbances of the machine affect all
/// alike.
/// @param json_file   Google Benchmark's own report.
/// @param progress called with the numbers of finished and of all runs.
std::vector<SpeedTable> measureSpeed(const std::vector<AnnotatedImage>& images,
                                     const std::vector<DetectorEntry>& detectors, bool quick,
                                     const std::filesystem::path& json_file,
                                     const std::function<void(int done, int all)>& progress);

}  // namespace vismem
