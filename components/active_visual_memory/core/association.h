/// @file Predicted against observed segments in the image: the three sets of figure 4. Pure. SPEC V5.
#pragma once

#include <vector>

#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

/// Labels that may belong to one thing: equal, or at least one unknown.
bool labelsCompatible(const Label& a, const Label& b);

struct AssociationParams {
  double max_angle_rad = 0.14;         ///< 8 degrees
  double max_normal_px = 8.0;          ///< distance of the middle of the overlap from the other's line
  double min_overlap = 0.3;            ///< of the shorter of the two
  bool use_polarity = true;            ///< edges must agree in which side is brighter, where both know it
  double min_polarity_strength = 6.0;  ///< grey levels; weaker edges do not know their polarity
  // Fragments of one line lie in line with each other in their image much better than with the prediction,
  // whose errors they share.
  double fragment_px = 2.0;    ///< a fragment's ends from the line of the matched one, at most ..
  double fragment_rad = 0.05;  ///< .. and this much for each pixel beyond its ends
};

/// What the memory expects, with what association needs beside the port's value.
struct Expectation {
  PredictedSegment predicted;
  double strength = 0.0;  ///< grey levels, mean of past observations
};

struct AssociationResult {
  std::vector<ImageAnalysis::Match> matches;  ///< one-to-one, best first
  /// Further observed segments on an already matched prediction and in line with its match: fragments of one
  /// line.
  std::vector<ImageAnalysis::Match> supports;
  std::vector<int> unobserved;   ///< predicted but not observed, ascending
  std::vector<int> unpredicted;  ///< observed but neither matched nor supporting, ascending
};

/// Lower is better; empty if a gate fails. Symmetric gates, ideal pixels.
std::optional<double> associationCost(const ImageSegment& observed, const Expectation& expected,
                                      const AssociationParams& params);

AssociationResult associate(const std::vector<ImageSegment>& observed,
                            const std::vector<Expectation>& expected, const AssociationParams& params);

}  // namespace vismem
