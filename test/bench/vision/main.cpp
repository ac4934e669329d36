// scripts/bench vision: the default segment detector beside published ones, in one process and one thread
// (V1).
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "bench/vision/accuracy_bench.h"
#include "bench/vision/report.h"
#include "bench/vision/speed.h"
#include "common/tool/command_line_tool.h"
#include "support/data_folder.h"

namespace {

using namespace vismem;

struct Options {
  std::filesystem::path images;
  std::filesystem::path truth;
  std::filesystem::path out = "out/bench-vision";
  double truth_shift_px = kAnnotationShift_px;
  std::vector<std::string> detectors;
  bool quick = false;
  bool speed = false;
  bool accuracy = false;
};

/// One line on the terminal; elsewhere a line every tenth.
class Progress {
 public:
  explicit Progress(std::string what) : what_(std::move(what)) {}
  void operator()(int done, int all) {
    const int tenths = 10 * done / std::max(1, all);
    if (isatty(STDERR_FILENO) != 0) {
      std::fprintf(stderr, "\r%s: %d of %d%s", what_.c_str(), done, all, done == all ? "\n" : "");
    } else if (tenths != tenths_) {
      std::fprintf(stderr, "%s: %d of %d\n", what_.c_str(), done, all);
    }
    tenths_ = tenths;
  }

 private:
  std::string what_;
  int tenths_ = 0;
};

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

std::vector<AnnotatedImage> everyNth(const std::vector<AnnotatedImage>& images, std::size_t n) {
  std::vector<AnnotatedImage> out;
  for (std::size_t i = 0; i < images.size(); i += n) out.push_back(images[i]);
  return out;
}

int run(const Options& options) {
  std::vector<AnnotatedImage> images = loadAnnotated(options.images, options.truth, options.truth_shift_px);
  if (images.empty()) {
    std::cerr << "bench vision: " << options.images.string()
              << ": no images there (set AVM_DATA or give --images DIR)\n";
    return 1;
  }
  std::filesystem::create_directories(options.out);
  cv::setNumThreads(1);
  VisionResults results;
  results.machine = processor() + ", 1 thread, OpenCV " CV_VERSION ", g++ " __VERSION__;
  results.images = options.images.string() + " (" + std::to_string(images.size()) + ")";
  auto detectors = measuredDetectors();
  if (!options.detectors.empty()) {
    std::erase_if(detectors, [&](const DetectorEntry& entry) {
      return !entry.ours && std::find(options.detectors.begin(), options.detectors.end(), entry.name) ==
                                options.detectors.end();
    });
  }
  if (options.quick) std::erase_if(detectors, [](const DetectorEntry& entry) { return entry.slow; });
  const bool both = options.speed == options.accuracy;
  if (both || options.speed) {
    results.speed = measureSpeed(images, detectors, options.quick, options.out / "google_benchmark.json",
                                 Progress("speed"));
  }
  if (both || options.accuracy) {
    results.photographs =
        measurePhotographs(options.quick ? everyNth(images, 5) : images, detectors, Progress("photographs"));
    results.exact = measureExact(detectors, options.quick ? 10 : 40, Progress("exact edges"));
  }
  const std::string text = textReport(results);
  std::cout << text;
  writeCsv(results, options.out);
  std::ofstream file(options.out / "report.txt");
  file << text;
  file.close();
  cv::Mat figure;
  cv::cvtColor(drawFigure(results), figure, cv::COLOR_RGB2BGR);
  if (!file || !cv::imwrite((options.out / "vision.png").string(), figure)) {
    throw std::runtime_error(options.out.string() + ": cannot be written");
  }
  nlohmann::json json = jsonReport(results);
  json["quick"] = options.quick;
  json["out"] = options.out.string();
  std::ofstream(options.out / "result.json") << json.dump() << '\n';
  std::cout << json.dump() << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.images = dataFolder() / "york_urban_half";
  CLI::App app{
      "Segment detectors on annotated photographs: time of the thread per image (320x240, 640x480, "
      "1920x1080), F at "
      "1, 2 and 5 px, one-to-one matches, fragments, redundancy, repeatability, exact edges and noise. "
      "Writes a "
      "report, CSV files and a figure; the last line is JSON.",
      "scripts/bench vision"};
  app.add_option("--images", options.images, "folder of photographs (default: york_urban_half in AVM_DATA)");
  app.add_option("--truth", options.truth,
                 "folder of NAME_gt.txt, x1 y1 x2 y2 a line (default: that of --images)");
  app.add_option("--truth-shift", options.truth_shift_px, "subtracted from every annotated coordinate [px]")
      ->capture_default_str();
  app.add_option("--out", options.out, "folder for all that is written")->capture_default_str();
  std::vector<std::string> names;
  for (const DetectorEntry& entry : measuredDetectors()) names.push_back(entry.name);
  app.add_option("--detectors", options.detectors,
                 "only these beside ours, with commas between (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  app.add_flag("--quick", options.quick, "fewer images and runs: a minute instead of several");
  app.add_flag("--speed", options.speed, "only the times");
  app.add_flag("--accuracy", options.accuracy, "only the accuracy");
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  if (options.truth.empty()) options.truth = options.images;
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::cerr << "bench vision: " << error.what() << '\n';
    return 1;
  }
}
