/// @file Data association of predicted and observed segments in the image: the three sets of figure 4.
/// Pure. Implements V5.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "common/config/parameter_visitor.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

struct AssociationParams {
  double max_angle_rad = 0.14;         ///< 8 degrees
  double max_normal_px = 8.0;          ///< distance of the middle of the overlap from the other's line
  double min_overlap = 0.3;            ///< of the shorter of the two
  bool use_polarity = true;            ///< edges must have one polarity, if both are known
  double min_polarity_strength = 6.0;  ///< grey levels; the polarity of weaker edges is unknown
  // Fragments of one line share the error of the prediction, so they lie in line with each other better than
  // with it.
  double fragment_px = 2.0;    ///< distance of the ends of a fragment from the line of the match: this ..
  double fragment_rad = 0.05;  ///< .. plus this per pixel beyond its ends

  void visit(ParameterVisitor& v) {
    v.angle(expert("Angle_deg", "V5: angle between an expected and an observed segment"), max_angle_rad, 0.1,
            90.0);
    v.real(expert("Normal_px", "V5: distance of an observed segment across the expected one"), max_normal_px,
           0.1, 200.0);
  }
};

/// A prediction with its contrast.
struct Expectation {
  PredictedSegment predicted;
  double strength = 0.0;  ///< grey levels, mean of past observations
};

struct AssociationResult {
  explicit AssociationResult(std::pmr::memory_resource* scratch)
      : matches(scratch), supports(scratch), unobserved(scratch), unpredicted(scratch) {}

  std::pmr::vector<ImageAnalysis::Match> matches;  ///< one-to-one, best first
  /// Further observed segments of a matched prediction, in line with its match: fragments of one line.
  std::pmr::vector<ImageAnalysis::Match> supports;
  std::pmr::vector<int> unobserved;   ///< predicted but not observed, ascending
  std::pmr::vector<int> unpredicted;  ///< observed but neither matched nor supporting, ascending
};

/// Greedy one-to-one assignment by rising cost.
AssociationResult associate(std::span<const ImageSegment> observed, std::span<const Expectation> expected,
                            const AssociationParams& params,
                            std::pmr::memory_resource* scratch = std::pmr::get_default_resource());

}  // namespace vismem
