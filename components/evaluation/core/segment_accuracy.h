/// @file The accuracy measure of york_urban_half: detections against annotated segments. Pure.
///
/// Two segments can match only if their directions differ by at most 10 degrees. The part of d that matches g
/// at tolerance t: its points at most t from g's line whose projection falls inside g. `P_t` is the matched
/// share of the length detected, `R_t` that of the annotated length (segments of at least 10 px); both are
/// averaged over images, `F_t = 2 P R / (P + R)`.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/geometry/segment.h"

namespace vismem {

/// [px] of the evaluated size.
constexpr std::array<double, 3> kTolerances_px{1.0, 2.0, 5.0};

struct PrecisionRecall {
  double precision = 0.0;
  double recall = 0.0;
  double f() const {
    return precision + recall > 0.0 ? 2.0 * precision * recall / (precision + recall) : 0.0;
  }
};

/// Fractions of a -> b.
struct SegmentSpan {
  double begin = 0.0;
  double end = 0.0;
};

/// The part of `d` that matches `g`; empty where there is none.
std::optional<SegmentSpan> matchedPart(const Segment2& d, const Segment2& g, double tolerance_px);

/// By length, for one image. @return 0 and 0 without any segment.
PrecisionRecall lengthMatch(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated,
                            double tolerance_px);

/// Accuracy of a detector in one image.
struct ImageScore {
  std::array<PrecisionRecall, 3> at;  ///< by length, at kTolerances_px
  /// sF5: one-to-one greedy matching on the mean end-point distance (best order), at most 5 px, no angle
  /// test.
  PrecisionRecall structural;
  /// Annotated segments of at least 30 px that are recalled by half (2 px), and the detections with a matched
  /// part of at least 3 px on them.
  long lines = 0;
  long fragments = 0;
  /// Recalled annotated length (2 px), and the summed length of all the parts that cover it.
  double recalled_px = 0.0;
  double covering_px = 0.0;
  long segments = 0;
};
ImageScore scoreImage(const std::vector<Segment2>& detected, const std::vector<Segment2>& annotated);

struct AccuracySummary {
  std::array<PrecisionRecall, 3> at;
  PrecisionRecall structural;
  double fragments = 0.0;   ///< mean detections per recalled annotated line
  double redundancy = 0.0;  ///< mean detections covering a recalled annotated pixel
  double segments = 0.0;    ///< per image
};
AccuracySummary summarize(const std::vector<ImageScore>& images);

}  // namespace vismem
