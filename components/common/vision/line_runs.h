/// @file Straight runs of edge points, fitted by total least squares. Pure. SPEC V1.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/segment.h"
#include "common/vision/edge_points.h"
#include "common/vision/segment_detector.h"

namespace vismem {

/// A straight run of edge points, the brighter side on the left.
struct LineRun {
  Segment2 px;
  double points = 0.0;  ///< on the line
};

/// Follows the links of edge points and cuts them into straight runs; the point that breaks a run begins the
/// next one. Keeps its work space.
class LineRunFinder {
 public:
  explicit LineRunFinder(const SolisParams& params) : params_(params) {}
  /// @param runs replaced.
  void find(const EdgePointFinder& edges, std::vector<LineRun>& runs);

 private:
  class Fit;

  int follow(const std::int32_t* next, std::int32_t first, bool ring);
  void gather(const EdgePoint* points, int count);
  void split(int count, std::vector<LineRun>& runs);
  int extend(Fit& fit, int from, int stop, int step);
  void emit(Fit& fit, int first, int last, std::vector<LineRun>& runs);
  bool agrees(const Fit& fit, int k, double sense) const;

  SolisParams params_;
  Room<std::uint8_t> used_;
  Room<std::int32_t> order_;
  // The points of one chain: place, gradient and its squared length times that of the cosine to agree.
  Room<float> x_, y_, gx_, gy_, agreement_;
  Room<std::uint8_t> on_line_;
};

}  // namespace vismem
