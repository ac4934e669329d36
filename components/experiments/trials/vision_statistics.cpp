#include "experiments/trials/vision_statistics.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

/// A segment belongs to a piece when both its ends are this near to the piece's line, and its middle beside
/// the piece.
constexpr double kOnLine_px = 3.0;
constexpr double kBeyondEnd_px = 8.0;
constexpr double kFoundShare = 0.5;
constexpr double kOnFloor_m = 0.02;

bool liesOn(const Segment2& segment, const Segment2& piece) {
  if (distanceToLine(segment.a, piece) > kOnLine_px || distanceToLine(segment.b, piece) > kOnLine_px) {
    return false;
  }
  return distanceToSegment(segment.middle(), piece) <= kOnLine_px;
}

template <std::size_t N>
std::size_t binOf(const std::array<double, N>& borders, double value) {
  std::size_t bin = 0;
  while (bin + 1 < N && value >= borders[bin + 1]) ++bin;
  return bin;
}

bool has(const std::vector<int>& sorted, int value) {
  return std::binary_search(sorted.begin(), sorted.end(), value);
}

}  // namespace

void VisionStatistics::add(const SegmentMap& edges, const std::vector<VisiblePiece>& visible,
                           const std::vector<ImageSegment>& observed) {
  ++images_;
  std::vector<bool> explained(observed.size(), false);
  std::vector<bool> on_any(observed.size(), false);
  std::vector<int> now_missed;
  std::vector<int> now_shown;
  for (const VisiblePiece& piece : visible) {
    const MapSegment& edge = edges.segments[static_cast<std::size_t>(piece.edge)];
    const double length = piece.px.length();
    std::vector<std::pair<double, double>> covered;
    int fragments = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      const ImageSegment& segment = observed[i];
      if (!liesOn(segment.px, piece.px)) continue;
      on_any[i] = true;
      if (!labelFitsMap(segment.label, edge.label)) continue;
      if (!explained[i] && (segment.px.b - segment.px.a).dot(piece.px.b - piece.px.a) < 0.0) ++wrong_side_;
      if (!explained[i]) ++right_;
      explained[i] = true;
      ++fragments;
      for (const Eigen::Vector2d& end : {segment.px.a, segment.px.b}) {
        const double off = distanceToLine(end, piece.px);
        across2_ += off * off;
        ++ends_;
      }
      double from = projectionFraction(segment.px.a, piece.px);
      double to = projectionFraction(segment.px.b, piece.px);
      if (from > to) std::swap(from, to);
      covered.emplace_back(from, to);
    }
    std::sort(covered.begin(), covered.end());
    double sum = 0.0;
    double reached = 0.0;
    for (const auto& [from, to] : covered) {
      sum += std::max(0.0, std::min(1.0, to) - std::max(reached, from));
      reached = std::max(reached, std::min(1.0, to));
    }
    const bool found = sum >= kFoundShare;
    if (found) {
      // An edge that goes on as another of the same label is found as one with it: not an error of the end.
      for (const double beyond : {-covered.front().first * length, (covered.back().second - 1.0) * length}) {
        if (std::abs(beyond) > kBeyondEnd_px) continue;
        along_ += beyond;
        along2_ += beyond * beyond;
        ++ends_along_;
      }
    }
    const auto count = [&](Bin& bin) {
      ++bin.pieces;
      bin.covered += sum;
      if (!found) return;
      ++bin.found;
      bin.fragments += fragments;
    };
    count(by_length_[binOf(kLengths_px, length)]);
    if (length < kFarFrom_px) continue;
    if (std::abs(edge.world.a.z()) <= kOnFloor_m && std::abs(edge.world.b.z()) <= kOnFloor_m) {
      count(by_range_[binOf(kRanges_m, piece.range_m)]);
    }
    now_shown.push_back(piece.edge);
    if (!found) now_missed.push_back(piece.edge);
    if (has(last_shown_, piece.edge)) {
      ++could_;
      if (!found) ++missed_now_;
      if (has(last_missed_, piece.edge)) {
        ++missed_;
        if (!found) ++missed_twice_;
      }
    }
  }
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const bool labelled = observed[i].label != kUnknownLabel;
    if (labelled) ++labelled_;
    if (on_any[i]) {
      ++on_piece_;
      if (!explained[i]) ++wrong_label_;
    }
    if (labelled && !explained[i]) {
      ++false_;
      false_length_ += observed[i].px.length();
    }
  }
  last_shown_ = std::move(now_shown);
  last_missed_ = std::move(now_missed);
  std::sort(last_shown_.begin(), last_shown_.end());
  std::sort(last_missed_.begin(), last_missed_.end());
}

}  // namespace vismem
