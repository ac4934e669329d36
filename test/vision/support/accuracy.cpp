#include "vision/support/accuracy.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr double kAnnotationShift_px = 0.75;  // clicks are 1-based; every detector fits best with this
constexpr double kMinimumAnnotated_px = 10.0;
constexpr double kFragmentTolerance_px = 2.0;
constexpr double kFragmentLine_px = 30.0;
constexpr double kFragmentPart_px = 3.0;
constexpr double kStructural_px = 5.0;

struct Interval {
  double begin = 0.0;  // fractions of a -> b
  double end = 0.0;
};

/// Restricts [t.begin, t.end] to where low <= c0 + c1 t <= high.
bool restrict(double c0, double c1, double low, double high, Interval& t) {
  if (std::abs(c1) < 1e-12) return c0 >= low && c0 <= high;
  double first = (low - c0) / c1;
  double second = (high - c0) / c1;
  if (first > second) std::swap(first, second);
  t.begin = std::max(t.begin, first);
  t.end = std::min(t.end, second);
  return t.begin < t.end;
}

std::optional<Interval> matchedPart(const Segment2& d, const Segment2& g, double tolerance_px) {
  if (lineAngleDifference(d.direction(), g.direction()) > degToRad(10.0)) return std::nullopt;
  const Eigen::Vector2d u = (g.b - g.a).normalized();
  const Eigen::Vector2d n(-u.y(), u.x());
  const Eigen::Vector2d a = d.a - g.a;
  const Eigen::Vector2d ab = d.b - d.a;
  Interval t{0.0, 1.0};
  if (!restrict(a.dot(n), ab.dot(n), -tolerance_px, tolerance_px, t)) return std::nullopt;
  if (!restrict(a.dot(u), ab.dot(u), 0.0, g.length(), t)) return std::nullopt;
  return t;
}

double unionLength(std::vector<Interval>& parts) {
  std::sort(parts.begin(), parts.end(), [](const auto& x, const auto& y) { return x.begin < y.begin; });
  double length = 0.0;
  double reached = 0.0;
  for (const auto& part : parts) {
    length += std::max(0.0, part.end - std::max(part.begin, reached));
    reached = std::max(reached, part.end);
  }
  return length;
}

double matchedShare(const Segment2& segment, const std::vector<Segment2>& others, double tolerance_px) {
  std::vector<Interval> parts;
  for (const auto& other : others) {
    if (const auto part = matchedPart(segment, other, tolerance_px)) parts.push_back(*part);
  }
  return unionLength(parts);
}

std::vector<Segment2> longEnough(const std::vector<Segment2>& segments, double minimum_px) {
  std::vector<Segment2> out;
  std::copy_if(segments.begin(), segments.end(), std::back_inserter(out),
               [&](const Segment2& segment) { return segment.length() >= minimum_px; });
  return out;
}

}  // namespace

std::vector<AnnotatedImage> loadAnnotated(const std::filesystem::path& folder, bool half) {
  std::vector<AnnotatedImage> images;
  if (!std::filesystem::is_directory(folder)) return images;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".jpg") continue;
    AnnotatedImage image;
    image.name = entry.path().stem().string();
    cv::cvtColor(cv::imread(entry.path().string()), image.rgb, cv::COLOR_BGR2RGB);
    // Halving moves centres too: the middle of pixels 0 and 1 becomes pixel 0.
    const double scale = half ? 0.5 : 1.0;
    if (half) cv::resize(image.rgb, image.rgb, image.rgb.size() / 2, 0, 0, cv::INTER_AREA);
    std::ifstream in(folder / (image.name + "_gt.txt"));
    Segment2 segment;
    while (in >> segment.a.x() >> segment.a.y() >> segment.b.x() >> segment.b.y()) {
      for (Eigen::Vector2d* end : {&segment.a, &segment.b}) {
        *end = ((*end).array() - kAnnotationShift_px) * scale;
      }
      if (segment.length() > 0.0) image.annotated.push_back(segment);
    }
    images.push_back(std::move(image));
  }
  std::sort(images.begin(), images.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return images;
}

Coverage coverage(const std::vector<Segment2>& segments, const std::vector<Segment2>& others,
                  double tolerance_px) {
  Coverage sum;
  for (const auto& segment : segments) {
    sum.matched_px += segment.length() * matchedShare(segment, others, tolerance_px);
    sum.total_px += segment.length();
  }
  return sum;
}

void AccuracyMeter::add(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated) {
  precision_sum_ += coverage(detected, annotated, tolerance_px_).share();
  recall_sum_ += coverage(longEnough(annotated, kMinimumAnnotated_px), detected, tolerance_px_).share();
  ++images_;
}

AccuracyFigures AccuracyMeter::figures() const {
  return images_ == 0 ? AccuracyFigures{} : AccuracyFigures{precision_sum_ / images_, recall_sum_ / images_};
}

void FragmentMeter::add(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated) {
  for (const auto& line : longEnough(annotated, kFragmentLine_px)) {
    if (matchedShare(line, detected, kFragmentTolerance_px) < 0.5) continue;
    ++lines_;
    for (const auto& segment : detected) {
      const auto part = matchedPart(segment, line, kFragmentTolerance_px);
      if (part && (part->end - part->begin) * segment.length() >= kFragmentPart_px) ++fragments_;
    }
  }
}

void StructuralMeter::add(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated) {
  const auto lines = longEnough(annotated, kMinimumAnnotated_px);
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < detected.size(); ++i) {
    for (std::size_t j = 0; j < lines.size(); ++j) {
      const double straight = (detected[i].a - lines[j].a).norm() + (detected[i].b - lines[j].b).norm();
      const double crossed = (detected[i].a - lines[j].b).norm() + (detected[i].b - lines[j].a).norm();
      const double mean = 0.5 * std::min(straight, crossed);
      if (mean <= kStructural_px) pairs.emplace_back(mean, i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> used_detected(detected.size(), false);
  std::vector<bool> used_line(lines.size(), false);
  int matched = 0;
  for (const auto& [mean, i, j] : pairs) {
    if (used_detected[i] || used_line[j]) continue;
    used_detected[i] = used_line[j] = true;
    ++matched;
  }
  precision_sum_ +=
      detected.empty() ? 0.0 : static_cast<double>(matched) / static_cast<double>(detected.size());
  recall_sum_ += lines.empty() ? 0.0 : static_cast<double>(matched) / static_cast<double>(lines.size());
  ++images_;
}

AccuracyFigures StructuralMeter::figures() const {
  return images_ == 0 ? AccuracyFigures{} : AccuracyFigures{precision_sum_ / images_, recall_sum_ / images_};
}

}  // namespace vismem
