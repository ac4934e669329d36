#include "experiments/trials/vision_statistics.h"

#include <algorithm>
#include <cmath>

namespace vismem {
namespace {

/// A segment belongs to a piece when both its ends are this near to the piece's line, and its middle beside
/// the piece.
constexpr double kOnLine_px = 3.0;
constexpr double kFoundShare = 0.5;
constexpr double kOnFloor_m = 0.02;

bool liesOn(const Segment2& segment, const Segment2& piece) {
  if (distanceToLine(segment.a, piece) > kOnLine_px || distanceToLine(segment.b, piece) > kOnLine_px) {
    return false;
  }
  return distanceToSegment(segment.middle(), piece) <= kOnLine_px;
}

bool isOnFloor(const MapSegment& edge) {
  return std::abs(edge.world.a.z()) <= kOnFloor_m && std::abs(edge.world.b.z()) <= kOnFloor_m;
}

template <std::size_t N>
std::size_t binOf(const std::array<double, N>& borders, double value) {
  std::size_t bin = 0;
  while (bin + 1 < N && value >= borders[bin + 1]) ++bin;
  return bin;
}

/// @param covered parts of the piece as fractions of its length, in order; not empty.
double beyondEnd(const std::vector<std::pair<double, double>>& covered, bool first, double length) {
  return first ? -covered.front().first * length : (covered.back().second - 1.0) * length;
}

std::int64_t endOf(int edge, bool first) {
  return 2 * static_cast<std::int64_t>(edge) + (first ? 0 : 1);
}

bool has(const std::vector<int>& sorted, int value) {
  return std::binary_search(sorted.begin(), sorted.end(), value);
}

}  // namespace

std::size_t VisionStatistics::rangeBin(double range_m) {
  return binOf(kRanges_m, range_m);
}

void VisionStatistics::beginRun() {
  for (LastingError* error : {&across_floor_, &across_upright_, &along_floor_, &along_upright_, &at_hidden_,
                              &outline_foot_, &outline_top_, &at_border_}) {
    error->beginRun();
  }
  for (auto* errors : {&across_by_range_, &along_by_range_}) {
    for (LastingError& error : *errors) error.beginRun();
  }
  last_missed_.clear();
  last_shown_.clear();
}

void VisionStatistics::add(double time_s, const CameraIntrinsics& intrinsics, const SegmentMap& edges,
                           const std::vector<VisiblePiece>& visible,
                           const std::vector<ImageSegment>& observed) {
  ++images_;
  std::vector<bool> explained(observed.size(), false);
  std::vector<bool> on_any(observed.size(), false);
  std::vector<int> now_missed;
  std::vector<int> now_shown;
  for (const VisiblePiece& piece : visible) {
    const MapSegment& edge = edges.segments[static_cast<std::size_t>(piece.edge)];
    const double length = piece.px.length();
    const bool on_floor = isOnFloor(edge);
    const Eigen::Vector2d along = (piece.px.b - piece.px.a) / length;
    const Eigen::Vector2d left(along.y(), -along.x());
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
      if (length >= kFarFrom_px && !piece.is_outline) {
        for (const bool first : {true, false}) {
          const Eigen::Vector2d& end = first ? segment.px.a : segment.px.b;
          const double beside = left.dot(end - piece.px.a);
          (on_floor ? across_floor_ : across_upright_).add(endOf(piece.edge, first), time_s, beside);
          if (on_floor) {
            across_by_range_[rangeBin(piece.range_m)].add(endOf(piece.edge, first), time_s, beside);
          }
        }
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
    if (piece.is_outline) {
      if (length < kFarFrom_px) continue;
      ++outlines_;
      if (!found) continue;
      ++outlines_found_;
      for (const bool first : {true, false}) {
        if (isAtBorder(intrinsics, first ? piece.px.a : piece.px.b)) continue;
        const double beyond = beyondEnd(covered, first, length);
        if (beyond < -kShort_px || beyond > kBeyond_px) continue;
        const bool is_top = first ? piece.hidden_a : piece.hidden_b;
        (is_top ? outline_top_ : outline_foot_).add(endOf(piece.edge, first), time_s, beyond);
      }
      continue;
    }
    for (const bool first : {true, false}) {
      if (!found || length < kFarFrom_px) break;
      const double beyond = beyondEnd(covered, first, length);
      if (beyond < -kShort_px || beyond > kBeyond_px) continue;
      const std::int64_t end = endOf(piece.edge, first);
      if (isAtBorder(intrinsics, first ? piece.px.a : piece.px.b)) {
        at_border_.add(end, time_s, beyond);
      } else if (!on_floor) {
        along_upright_.add(end, time_s, beyond);
      } else if (first ? piece.hidden_a : piece.hidden_b) {
        at_hidden_.add(end, time_s, beyond);
      } else {
        along_floor_.add(end, time_s, beyond);
        along_by_range_[rangeBin(piece.range_m)].add(end, time_s, beyond);
      }
    }
    const auto count = [&](Bin& bin) {
      ++bin.pieces;
      bin.length_found += sum;
      if (!found) return;
      ++bin.found;
      bin.fragments += fragments;
    };
    count(by_length_[binOf(kLengths_px, length)]);
    if (length < kFarFrom_px) continue;
    if (on_floor) {
      count(by_range_[rangeBin(piece.range_m)]);
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
  const auto isLabelOfFloor = [&edges](const Label& label) {
    return std::any_of(edges.segments.begin(), edges.segments.end(), [&](const MapSegment& edge) {
      return isOnFloor(edge) && labelFitsMap(label, edge.label);
    });
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const bool labelled = observed[i].label != kUnknownLabel;
    if (labelled) ++labelled_;
    if (on_any[i]) {
      ++on_piece_;
      if (!explained[i]) ++wrong_label_;
    }
    if (labelled && !explained[i]) {
      ++false_;
      if (isLabelOfFloor(observed[i].label)) ++false_on_floor_;
      false_length_ += observed[i].px.length();
    }
  }
  last_shown_ = std::move(now_shown);
  last_missed_ = std::move(now_missed);
  std::sort(last_shown_.begin(), last_shown_.end());
  std::sort(last_missed_.begin(), last_missed_.end());
}

}  // namespace vismem
