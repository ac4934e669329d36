/// @file The accuracy measure of york_urban_half: detections against annotated segments.
/// Two segments can match only if their directions differ by at most 10 degrees. The part of d that matches g
/// at tolerance t: its points at most t from g's line whose projection falls inside g.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

struct AnnotatedImage {
  std::string name;
  cv::Mat rgb;                      ///< brought to the evaluated size by area averaging
  std::vector<Segment2> annotated;  ///< in pixels of that size, centres on integers
};

/// @param half 320x240 instead of 640x480. @return empty when the folder is absent.
std::vector<AnnotatedImage> loadAnnotated(const std::filesystem::path& folder, bool half);

/// Share of the length of `segments` that is matched by `others` (union of matched parts); weights for means.
struct Coverage {
  double matched_px = 0.0;
  double total_px = 0.0;
  double share() const { return total_px > 0.0 ? matched_px / total_px : 0.0; }
};
Coverage coverage(const std::vector<Segment2>& segments, const std::vector<Segment2>& others,
                  double tolerance_px);

struct AccuracyFigures {
  double precision = 0.0;
  double recall = 0.0;
  double f() const {
    return precision + recall > 0.0 ? 2.0 * precision * recall / (precision + recall) : 0.0;
  }
};

/// Sums over images; recall counts annotated segments of at least 10 px.
class AccuracyMeter {
 public:
  explicit AccuracyMeter(double tolerance_px) : tolerance_px_(tolerance_px) {}
  void add(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated);
  AccuracyFigures figures() const;

 private:
  double tolerance_px_;
  double precision_sum_ = 0.0;
  double recall_sum_ = 0.0;
  int images_ = 0;
};

/// Mean number of detections with a matched part of at least 3 px on an annotated segment of at least 30 px
/// that is recalled by at least half (tolerance 2 px).
class FragmentMeter {
 public:
  void add(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated);
  double mean() const { return lines_ > 0 ? static_cast<double>(fragments_) / lines_ : 0.0; }

 private:
  long fragments_ = 0;
  long lines_ = 0;
};

/// Structural: one-to-one greedy matching on the mean end-point distance (best order of ends), at most 5 px.
class StructuralMeter {
 public:
  void add(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated);
  AccuracyFigures figures() const;

 private:
  double precision_sum_ = 0.0;
  double recall_sum_ = 0.0;
  int images_ = 0;
};

}  // namespace vismem
