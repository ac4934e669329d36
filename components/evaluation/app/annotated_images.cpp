#include "evaluation/app/annotated_images.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

#include "common/vision/app/image_file.h"

namespace vismem {
namespace {

bool isImageName(const std::filesystem::path& file) {
  static const char* const kEndings[] = {".jpg", ".jpeg", ".png", ".bmp", ".pgm", ".ppm", ".tif", ".tiff"};
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

std::vector<Segment2> readAnnotation(const std::filesystem::path& file, double shift_px) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read (each image needs its annotation)");
  std::vector<Segment2> segments;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream cells(line);
    Segment2 segment;
    std::string rest;
    if (!(cells >> segment.a.x() >> segment.a.y() >> segment.b.x() >> segment.b.y()) || cells >> rest) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": " + line +
                               " (must be x1 y1 x2 y2)");
    }
    for (Eigen::Vector2d* end : {&segment.a, &segment.b}) end->array() -= shift_px;
    if (segment.length() > 0.0) segments.push_back(segment);
  }
  return segments;
}

}  // namespace

AnnotatedImage loadAnnotatedImage(const std::filesystem::path& file, const std::filesystem::path& truth,
                                  double shift_px) {
  AnnotatedImage image;
  image.name = file.stem().string();
  image.rgb = readImageFile(file);
  image.annotated = readAnnotation(truth / (image.name + "_gt.txt"), shift_px);
  return image;
}

std::vector<AnnotatedImage> loadAnnotated(const std::filesystem::path& images,
                                          const std::filesystem::path& truth, double shift_px) {
  std::vector<AnnotatedImage> loaded;
  if (!std::filesystem::is_directory(images)) return loaded;
  for (const auto& entry : std::filesystem::directory_iterator(images)) {
    if (!isImageName(entry.path())) continue;
    loaded.push_back(loadAnnotatedImage(entry.path(), truth, shift_px));
  }
  std::sort(loaded.begin(), loaded.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return loaded;
}

AnnotatedImage atWidth(const AnnotatedImage& image, int width) {
  if (width == image.rgb.cols) return image;
  AnnotatedImage out{image.name, {}, image.annotated};
  const double scale = static_cast<double>(width) / image.rgb.cols;
  const int height = std::max(1, static_cast<int>(std::lround(image.rgb.rows * scale)));
  cv::resize(image.rgb, out.rgb, cv::Size(width, height), 0, 0, cv::INTER_AREA);
  for (Segment2& segment : out.annotated) {
    segment.a *= scale;
    segment.b *= scale;
  }
  return out;
}

}  // namespace vismem
