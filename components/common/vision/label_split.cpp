#include "common/vision/label_split.h"

#include <algorithm>

namespace vismem {
namespace {

constexpr double kStep_px = 2.0;    // between the windows that are labelled
constexpr double kWindow_px = 6.0;  // their length: three samples tell a majority

/// A stretch of one known label, in pixels from end a.
struct Run {
  const Label* label;
  double from_px;
  double to_px;
};

}  // namespace

std::vector<LabelledPiece> splitByLabel(const cv::Mat& image, const Segment2& px, const Palette& palette,
                                        const LabellerParams& params, double minimum_px) {
  const auto whole = [&] {
    return std::vector<LabelledPiece>{{px, segmentLabel(image, px, palette, params)}};
  };
  const double length = px.length();
  if (length < 2.0 * minimum_px) return whole();
  const Eigen::Vector2d along = (px.b - px.a) / length;
  LabellerParams window = params;
  window.samples = 3;
  window.trim = 0.0;

  std::vector<Run> runs;
  const double half = 0.5 * kWindow_px;
  for (double at = half; at <= length - half; at += kStep_px) {
    const Segment2 part{px.a + (at - half) * along, px.a + (at + half) * along};
    const Label& label = segmentLabel(image, part, palette, window);
    if (label == kUnknownLabel) continue;  // says nothing: it neither ends nor begins a run
    if (!runs.empty() && *runs.back().label == label) {
      runs.back().to_px = at;
    } else {
      runs.push_back({&label, at, at});
    }
  }
  std::erase_if(runs, [&](const Run& run) { return run.to_px - run.from_px + kWindow_px < minimum_px; });
  std::vector<Run> joined;
  for (const Run& run : runs) {
    if (!joined.empty() && *joined.back().label == *run.label) {
      joined.back().to_px = run.to_px;
    } else {
      joined.push_back(run);
    }
  }
  if (joined.size() < 2) return whole();

  std::vector<LabelledPiece> pieces;
  double begin = 0.0;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const bool last = i + 1 == joined.size();
    const double end = last ? length : 0.5 * (joined[i].to_px + joined[i + 1].from_px);
    pieces.push_back({{px.a + begin * along, px.a + end * along}, *joined[i].label});
    begin = end;
  }
  return pieces;
}

}  // namespace vismem
