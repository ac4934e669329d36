#include "bench/vision/accuracy_bench.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>

#include "vision/support/synthetic_scenes.h"

namespace vismem {
namespace {

constexpr int kResamplings = 2000;
constexpr int kScenesSeed = 4000;
constexpr int kNoiseSeed = 9000;
constexpr double kNoiseOnly[] = {5.0, 15.0, 40.0};

std::vector<Segment2> detect(MeasuredDetector& detector, const cv::Mat& gray) {
  detector.run(gray);
  return detector.segments();
}

std::vector<ImageScore> half(const std::vector<ImageScore>& images, std::size_t first) {
  std::vector<ImageScore> out;
  for (std::size_t i = first; i < images.size(); i += 2) out.push_back(images[i]);
  return out;
}

PhotographRow measureRow(const DetectorEntry& entry, const std::vector<AnnotatedImage>& images) {
  PhotographRow row;
  row.detector = entry.name;
  const auto detector = entry.make();
  for (std::size_t i = 0; i < images.size(); ++i) {
    cv::Mat gray;
    cv::cvtColor(images[i].rgb, gray, cv::COLOR_RGB2GRAY);
    row.images.push_back(scoreImage(detect(*detector, gray), images[i].annotated));
    const TwoViews views = makeTwoViews(gray, i + 1);
    const auto found_a = detect(*detector, views.a);
    row.repeatability.add(compareViews(views, found_a, detect(*detector, views.b)));
  }
  row.all = summarize(row.images);
  row.even = summarize(half(row.images, 0));
  row.odd = summarize(half(row.images, 1));
  return row;
}

Difference difference(const std::vector<PhotographRow>& rows, const std::string& measure) {
  const PhotographRow& ours = rows.front();
  const PhotographRow* peer = nullptr;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (peer == nullptr || measureOf(rows[i].all, measure) > measureOf(peer->all, measure)) peer = &rows[i];
  }
  Difference result{measure, {}, measureOf(ours.all, measure), 0.0, 0.0, 0.0};
  if (peer == nullptr) return result;
  result.peer = peer->detector;
  result.theirs = measureOf(peer->all, measure);
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::size_t> pick(0, ours.images.size() - 1);
  std::vector<double> differences;
  for (int k = 0; k < kResamplings; ++k) {
    std::vector<ImageScore> mine;
    std::vector<ImageScore> others;
    for (std::size_t i = 0; i < ours.images.size(); ++i) {
      const std::size_t image = pick(random);
      mine.push_back(ours.images[image]);
      others.push_back(peer->images[image]);
    }
    differences.push_back(measureOf(summarize(mine), measure) - measureOf(summarize(others), measure));
  }
  std::sort(differences.begin(), differences.end());
  result.low = differences[kResamplings / 40];
  result.high = differences[kResamplings - 1 - kResamplings / 40];
  return result;
}

}  // namespace

double measureOf(const AccuracySummary& summary, const std::string& measure) {
  if (measure == "F1") return summary.at[0].f();
  if (measure == "F2") return summary.at[1].f();
  if (measure == "F5") return summary.at[2].f();
  return summary.structural.f();
}

std::vector<PhotographTable> measurePhotographs(const std::vector<AnnotatedImage>& images,
                                                const std::vector<DetectorEntry>& detectors,
                                                const std::function<void(int done, int all)>& progress) {
  const auto narrowest = std::min_element(images.begin(), images.end(), [](const auto& a, const auto& b) {
                           return a.rgb.cols < b.rgb.cols;
                         })->rgb.cols;
  std::vector<PhotographTable> tables;
  int done = 0;
  for (const int width : {320, 640}) {
    if (width > narrowest) continue;
    std::vector<AnnotatedImage> sized;
    PhotographTable table;
    for (const AnnotatedImage& image : images) {
      sized.push_back(atWidth(image, width));
      table.names.push_back(image.name);
    }
    table.size = std::to_string(width) + "x" + std::to_string(sized.front().rgb.rows);
    table.images = static_cast<int>(images.size());
    for (const DetectorEntry& entry : detectors) {
      table.rows.push_back(measureRow(entry, sized));
      progress(++done, static_cast<int>((narrowest >= 640 ? 2 : 1) * detectors.size()));
    }
    for (const char* measure : {"F1", "F2", "F5", "sF5"}) {
      table.differences.push_back(difference(table.rows, measure));
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<ExactRow> measureExact(const std::vector<DetectorEntry>& detectors, int scenes,
                                   const std::function<void(int done, int all)>& progress) {
  std::vector<ExactRow> rows;
  int done = 0;
  for (const DetectorEntry& entry : detectors) {
    ExactRow row;
    row.detector = entry.name;
    const auto detector = entry.make();
    for (const double sigma : {3.0, 10.0}) {
      PrecisionRecall mean;
      EndLineError error;
      for (int i = 0; i < scenes; ++i) {
        const SyntheticScene scene = makeScene(sigma, static_cast<std::uint64_t>(kScenesSeed + i));
        const auto found = detect(*detector, scene.gray);
        const PrecisionRecall one = lengthMatch(found, scene.edges, 1.0);
        mean.precision += one.precision / scenes;
        mean.recall += one.recall / scenes;
        error.add(endLineError(found, scene.edges));
      }
      (sigma < 5.0 ? row.f1_at_noise_3 : row.f1_at_noise_10) = mean.f();
      (sigma < 5.0 ? row.rms_px_at_noise_3 : row.rms_px_at_noise_10) = error.rms_px();
    }
    for (std::size_t k = 0; k < std::size(kNoiseOnly); ++k) {
      for (int i = 0; i < scenes; ++i) {
        const cv::Mat noise = makeNoise(kNoiseOnly[k], static_cast<std::uint64_t>(kNoiseSeed + i));
        row.false_segments[k] += static_cast<double>(detect(*detector, noise).size()) / scenes;
      }
    }
    rows.push_back(row);
    progress(++done, static_cast<int>(detectors.size()));
  }
  return rows;
}

}  // namespace vismem
