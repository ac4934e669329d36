#include "localization/core/observation/sampling_grid.h"

#include <algorithm>

namespace vismem {
namespace {

constexpr double kReferenceHeight_px = 240.0;  // image height of the chapter's pixel values

}  // namespace

SamplingGrid::SamplingGrid(int width, int height, double top_px, double bottom_px) : width_(width) {
  const double scale = height / kReferenceHeight_px;
  double border = 0.0;
  while (border < height) {
    row_borders_.push_back(border);
    border += scale * (top_px + (bottom_px - top_px) * border / height);
  }
  row_borders_.push_back(height);
}

std::vector<Eigen::Vector2d> SamplingGrid::crossings(const Segment2& px) const {
  std::vector<double> fractions;
  const Eigen::Vector2d along = px.b - px.a;
  const auto addCrossing = [&](double from, double slope, double line, double low, double high) {
    if (slope == 0.0) return;
    const double fraction = (line - from) / slope;
    if (fraction >= low && fraction <= high) fractions.push_back(fraction);
  };
  for (std::size_t row = 0; row + 1 < row_borders_.size(); ++row) {
    const double top = row_borders_[row];
    const double bottom = row_borders_[row + 1];
    addCrossing(px.a.y(), along.y(), top, 0.0, 1.0);
    // Crossings of the part inside this row with the row's vertical lines.
    double low = 0.0;
    double high = 1.0;
    if (along.y() == 0.0) {
      if (px.a.y() < top || px.a.y() >= bottom) continue;
    } else {
      const double f0 = (top - px.a.y()) / along.y();
      const double f1 = (bottom - px.a.y()) / along.y();
      low = std::max(low, std::min(f0, f1));
      high = std::min(high, std::max(f0, f1));
      if (low >= high) continue;
    }
    for (double x = 0.0; x <= width_; x += bottom - top) addCrossing(px.a.x(), along.x(), x, low, high);
  }
  std::sort(fractions.begin(), fractions.end());
  std::vector<Eigen::Vector2d> points;
  double last = -1.0;
  const double length = along.norm();
  for (const double fraction : fractions) {
    // At a corner of a cell two lines cross the segment at one point.
    if (last >= 0.0 && (fraction - last) * length < 0.5) continue;
    points.push_back(px.a + fraction * along);
    last = fraction;
  }
  return points;
}

}  // namespace vismem
