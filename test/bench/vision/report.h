/// @file The results as text, CSV, JSON and a figure.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "bench/vision/accuracy_bench.h"
#include "bench/vision/speed.h"

namespace vismem {

struct VisionResults {
  std::string machine;  ///< processor, OpenCV, build
  std::string images;   ///< folder
  std::vector<SpeedTable> speed;
  std::vector<PhotographTable> photographs;
  std::vector<ExactRow> exact;
};

std::string textReport(const VisionResults& results);
nlohmann::json jsonReport(const VisionResults& results);
/// speed.csv, accuracy.csv, accuracy_images.csv (one row per image, size and detector), exact.csv; the
/// measured ones only.
/// @throws std::runtime_error naming the file that cannot be written.
void writeCsv(const VisionResults& results, const std::filesystem::path& folder);
/// Time against F2 at each size, and every measure side by side. CV_8UC3 (R, G, B).
cv::Mat drawFigure(const VisionResults& results);

}  // namespace vismem
