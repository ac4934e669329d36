/// @file Straight runs of edge points, fitted by total least squares. Pure. See V1.
#pragma once

#include <cstdint>
#include <span>

#include "common/vision/edge_points.h"
#include "common/vision/line_run_kernel.h"
#include "common/vision/segment_detector.h"

namespace vismem {

/// Cuts linked edge points into straight runs; the point that ends a run begins the next one. Keeps its work
/// space.
class LineRunFinder {
 public:
  LineRunFinder(const SolisParams& params, const EdgeRowKernel& kernel);
  /// @return valid until the next call.
  std::span<const LineRun> find(const EdgePointFinder& edges);

 private:
  LineRunParams params_;
  const EdgeRowKernel& kernel_;
  Room<std::int32_t> starts_, tops_, strays_, agrees_;
  Room<std::uint8_t> used_;
  Room<ChainPlace> place_;
  Room<ChainGradient> gradient_;
  Room<PointSums> sums_;
  Room<LineRun> runs_;
};

}  // namespace vismem
