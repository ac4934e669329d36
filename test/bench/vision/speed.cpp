#include "bench/vision/speed.h"

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace vismem {
namespace {

constexpr int kMosaicWidth = 1920;
constexpr int kMosaicHeight = 1080;
constexpr int kSlowShare = 3;

double threadSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

cv::Mat grayOf(const cv::Mat& rgb) {
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

/// Every n-th, so that all parts of the collection are there.
std::vector<const AnnotatedImage*> spread(const std::vector<AnnotatedImage>& images, std::size_t count) {
  std::vector<const AnnotatedImage*> chosen;
  const std::size_t n = std::min(count, images.size());
  for (std::size_t i = 0; i < n; ++i) chosen.push_back(&images[i * images.size() / n]);
  return chosen;
}

/// Photographs side by side in their native pixels, beginning with the first-th.
cv::Mat mosaic(const std::vector<AnnotatedImage>& images, std::size_t first) {
  cv::Mat out(kMosaicHeight, kMosaicWidth, CV_8UC1);
  std::size_t next = first;
  for (int y = 0; y < kMosaicHeight;) {
    int row_height = kMosaicHeight - y;
    for (int x = 0; x < kMosaicWidth;) {
      const cv::Mat gray = grayOf(images[next++ % images.size()].rgb);
      const int width = std::min(gray.cols, kMosaicWidth - x);
      const int height = std::min(gray.rows, kMosaicHeight - y);
      gray(cv::Rect(0, 0, width, height)).copyTo(out(cv::Rect(x, y, width, height)));
      row_height = std::min(row_height, height);
      x += width;
    }
    y += row_height;
  }
  return out;
}

/// One detector at one size.
struct Case {
  const DetectorEntry* entry = nullptr;
  const std::vector<cv::Mat>* images = nullptr;
  std::unique_ptr<MeasuredDetector> detector;
  std::vector<std::vector<double>> seconds;  // per image
  std::size_t segments = 0;                  // of one run over all images
};

struct Workload {
  std::string size;
  std::vector<cv::Mat> images;
  int runs = 0;
};

std::vector<Workload> workloads(const std::vector<AnnotatedImage>& images, bool quick) {
  std::vector<Workload> all;
  const auto add = [&](int width, std::size_t count, int runs) {
    Workload work;
    for (const AnnotatedImage* image : spread(images, count)) {
      if (image->rgb.cols >= width) work.images.push_back(grayOf(atWidth(*image, width).rgb));
    }
    if (work.images.empty()) return;
    work.size = std::to_string(width) + "x" + std::to_string(work.images.front().rows);
    work.runs = runs;
    all.push_back(std::move(work));
  };
  add(320, quick ? 5 : 20, quick ? 9 : 31);
  add(640, quick ? 3 : 10, quick ? 5 : 15);
  Workload large{std::to_string(kMosaicWidth) + "x" + std::to_string(kMosaicHeight), {}, quick ? 3 : 9};
  for (std::size_t i = 0; i < (quick ? 1u : 3u); ++i) large.images.push_back(mosaic(images, 9 * i));
  all.push_back(std::move(large));
  return all;
}

SpeedRow rowOf(const Case& measured) {
  SpeedRow row;
  row.detector = measured.entry->name;
  for (const auto& samples : measured.seconds) {
    const double ms = 1e3 * median(samples);
    row.ms += ms / static_cast<double>(measured.seconds.size());
    row.worst_ms = std::max(row.worst_ms, ms);
  }
  row.segments = static_cast<double>(measured.segments) / static_cast<double>(measured.images->size());
  return row;
}

}  // namespace

double SpeedTable::msOf(const std::string& detector) const {
  for (const SpeedRow& row : rows) {
    if (row.detector == detector) return row.ms;
  }
  return 0.0;
}

std::vector<SpeedTable> measureSpeed(const std::vector<AnnotatedImage>& images,
                                     const std::vector<DetectorEntry>& detectors, bool quick,
                                     const std::filesystem::path& json_file,
                                     const std::function<void(int done, int all)>& progress) {
  const std::vector<Workload> work = workloads(images, quick);
  std::vector<std::vector<std::unique_ptr<Case>>> cases(work.size());
  int all = 0;
  int done = 0;
  for (std::size_t w = 0; w < work.size(); ++w) {
    for (const DetectorEntry& entry : detectors) {
      const bool large = work[w].images.front().cols >= kMosaicWidth;
      if (entry.slow && large) continue;
      auto& one = *cases[w].emplace_back(std::make_unique<Case>());
      one.entry = &entry;
      one.images = &work[w].images;
      one.seconds.resize(work[w].images.size());
      const int runs = entry.slow ? std::max(1, work[w].runs / kSlowShare) : work[w].runs;
      all += runs;
      auto run = [&one, &done, &all, &progress](benchmark::State& state) {
        if (!one.detector) {  // buffers and caches are warm, and the segments counted, before the first
                              // timing
          one.detector = one.entry->make();
          for (const cv::Mat& image : *one.images) {
            one.detector->run(image);
            one.segments += one.detector->segments().size();
          }
        }
        std::size_t i = 0;
        for ([[maybe_unused]] auto _ : state) {
          const double begin = threadSeconds();
          one.detector->run((*one.images)[i]);
          const double seconds = threadSeconds() - begin;
          one.seconds[i].push_back(seconds);
          state.SetIterationTime(seconds);
          i = (i + 1) % one.images->size();
        }
        progress(++done, all);
      };
      benchmark::RegisterBenchmark((entry.name + "/" + work[w].size).c_str(), run)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond)
          ->Iterations(static_cast<benchmark::IterationCount>(work[w].images.size()))
          ->Repetitions(runs);
    }
  }
  // An iteration is one image, a repetition all images once; repetitions of all detectors are shuffled.
  char program[] = "vision";
  char interleave[] = "--benchmark_enable_random_interleaving=true";
  char* arguments[] = {program, interleave, nullptr};
  int count = 2;
  benchmark::Initialize(&count, arguments);
  std::ofstream file(json_file);
  if (!file) throw std::runtime_error(json_file.string() + ": cannot be written");
  benchmark::JSONReporter reporter;
  reporter.SetOutputStream(&file);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();

  std::vector<SpeedTable> tables;
  for (std::size_t w = 0; w < work.size(); ++w) {
    SpeedTable table{work[w].size, static_cast<int>(work[w].images.size()), work[w].runs, {}};
    for (const auto& one : cases[w]) table.rows.push_back(rowOf(*one));
    tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace vismem
