// detect_segments: straight segments of images as CSV and pictures.
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>

#include "common/config/text_format.h"
#include "common/tool/command_line_tool.h"
#include "common/vision/app/drawing.h"
#include "common/vision/app/image_file.h"
#include "common/vision/segment_detector.h"

namespace {

using vismem::RawSegment;

struct Options {
  std::string detector = "solis";
  std::string size;
  double minimum_length_px = 0.0;
  std::string csv;
  std::string overlay;
  std::vector<std::string> images;
};

/// "WxH" with both > 0.
std::optional<cv::Size> parseSize(const std::string& text) {
  int width = 0;
  int height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 1 || height < 1)
    return std::nullopt;
  return cv::Size(width, height);
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

class Run {
 public:
  Run(const Options& options, std::optional<cv::Size> size)
      : options_(options), size_(size), detector_(vismem::makeSegmentDetector(options.detector)) {}

  int operator()() {
    std::ofstream file;
    if (!options_.csv.empty()) {
      file.open(options_.csv);
      if (!file) return fail(options_.csv + ": cannot be written");
    }
    std::ostream* csv = !options_.csv.empty() ? &file : options_.overlay.empty() ? &std::cout : nullptr;
    if (!options_.overlay.empty()) {
      std::error_code error;
      std::filesystem::create_directories(options_.overlay, error);
      if (error) return fail(options_.overlay + ": " + error.message());
    }
    if (csv != nullptr) *csv << "image,x1_px,y1_px,x2_px,y2_px,label,strength\n";
    for (const std::string& name : options_.images) process(name, csv);
    if (csv != nullptr) csv->flush();
    if (csv != nullptr && !*csv) return fail(options_.csv + ": cannot be written");
    // With the CSV on standard output, the summary goes to standard error.
    (csv == &std::cout ? std::cerr : std::cout)
        << "{\"images\": " << images_ << ", \"unreadable\": " << unreadable_
        << ", \"segments\": " << segments_ << ", \"detector\": \"" << options_.detector
        << "\", \"ms_per_image\": " << (images_ > 0 ? 1e3 * seconds_ / images_ : 0.0) << "}\n";
    return unreadable_ == 0 && !failed_ ? 0 : 1;
  }

 private:
  static int fail(const std::string& what) {
    std::cerr << "detect_segments: " << what << '\n';
    return 1;
  }

  void process(const std::string& name, std::ostream* csv) {
    cv::Mat image;
    try {
      image = vismem::readImageFile(name);
    } catch (const std::exception& error) {
      fail(error.what());
      ++unreadable_;
      return;
    }
    if (size_ && image.size() != *size_) cv::resize(image, image, *size_, 0, 0, cv::INTER_AREA);
    std::vector<RawSegment> segments;
    const auto start = std::chrono::steady_clock::now();
    detector_->detect(image, segments);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::erase_if(segments, [this](const RawSegment& segment) {
      return segment.px_raw.length() < options_.minimum_length_px;
    });
    ++images_;
    segments_ += segments.size();
    if (csv != nullptr) write(*csv, name, segments);
    if (!options_.overlay.empty()) draw(name, image, segments);
  }

  static void write(std::ostream& csv, const std::string& name, const std::vector<RawSegment>& segments) {
    for (const auto& [px, strength] : segments) {
      csv << quoted(name)
          << vismem::formatted(",%.3f,%.3f,%.3f,%.3f,unknown,%.2f\n", px.a.x(), px.a.y(), px.b.x(), px.b.y(),
                               strength);
    }
  }

  void draw(const std::string& name, const cv::Mat& image, const std::vector<RawSegment>& segments) {
    cv::Mat canvas = vismem::magnifiedForDrawing(image);
    for (const RawSegment& segment : segments)
      vismem::drawSegment(canvas, image, segment.px_raw, {255, 0, 0});
    // Images of equal names from several folders get different files: name.png, name_2.png ...
    const std::string stem = std::filesystem::path(name).stem().string();
    std::string unique = stem;
    for (int n = 2; !drawn_.insert(unique).second; ++n) unique = stem + "_" + std::to_string(n);
    try {
      vismem::writeImageFile(canvas, std::filesystem::path(options_.overlay) / (unique + ".png"));
    } catch (const std::runtime_error& error) {
      fail(error.what());
      failed_ = true;
    }
  }

  Options options_;
  std::optional<cv::Size> size_;
  std::unique_ptr<vismem::SegmentDetector> detector_;
  std::size_t segments_ = 0;
  int images_ = 0;
  int unreadable_ = 0;
  std::set<std::string> drawn_;
  double seconds_ = 0.0;
  bool failed_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Detects straight segments in images. Coordinates are pixels of the evaluated size, centres on "
      "integers; the brighter side is on the left of (x1, y1) -> (x2, y2)."};
  app.add_option("--detector", options.detector, "solis (ours), chapter (published Solis) or hough")
      ->check(CLI::IsMember(vismem::segmentDetectorNames()));
  app.add_option("--size", options.size, "WxH: images are brought to this size by area averaging")
      ->check([](const std::string& text) {
        return parseSize(text) ? std::string() : text + " (must be WxH, for example 320x240)";
      });
  app.add_option("--min-length", options.minimum_length_px, "shorter segments are left out [px]")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--csv", options.csv, "file to write (without it and without --overlay: standard output)");
  app.add_option("--overlay", options.overlay, "folder for pictures with the segments drawn");
  app.add_option("IMAGE", options.images, "images to read")->required();
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    cv::setNumThreads(1);
    return Run(options, parseSize(options.size))();
  } catch (const std::exception& error) {
    std::cerr << "detect_segments: " << error.what() << '\n';
    return 1;
  }
}
