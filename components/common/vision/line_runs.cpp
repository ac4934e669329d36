#include "common/vision/line_runs.h"

namespace vismem {

LineRunFinder::LineRunFinder(const SolisParams& params, const EdgeRowKernel& kernel)
    : params_{params.first_fit_points, params.first_fit_rms_px, params.line_tolerance_px,
              params.maximum_strays,   params.maximum_rms_px,   params.piece_length_px,
              params.alignment_cos,    params.alignment_share},
      kernel_(kernel) {}

std::span<const LineRun> LineRunFinder::find(const EdgePointFinder& edges) {
  const std::size_t room = static_cast<std::size_t>(edges.capacity()) + 2 * kEdgePointBlock;
  for (auto* list : {&starts_, &tops_, &strays_, &agrees_}) list->reserve(room);
  used_.reserve(room);
  place_.reserve(room);
  gradient_.reserve(room);
  sums_.reserve(room + 1);
  runs_.reserve(room);
  const EdgeChainEnds ends = edges.listStarts(starts_.data(), tops_.data());
  const LinkedPoints points{edges.points(), edges.next(), edges.rowBegins(), edges.count()};
  const LineRunWork work{starts_.data(),   tops_.data(), used_.data(),   place_.data(),
                         gradient_.data(), sums_.data(), strays_.data(), agrees_.data()};
  const int found = kernel_.runs(params_, points, ends, work, runs_.data());
  return {runs_.data(), static_cast<std::size_t>(found)};
}

}  // namespace vismem
