#include "localization/core/health.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vismem {
namespace {

constexpr double kReferenceWidth_px = 320.0;  // the size of image that the chapter's pixel values are for
constexpr double kReferenceHeight_px = 240.0;

/// Beyond a map of 20 m the fields pay for themselves only where something is near: searching goes on by
/// brute force outside, so the truncation changes speed alone.
constexpr double kTruncation_m = 2.0;

/// So many times what leaves too little health, however sums were rounded.
constexpr double kCertainlyEnough = 1.000001;

/// A point further than so many times the scale from its line ends the hope for a place, or nearly.
constexpr double kFarScales = 1.5;

}  // namespace

MapIndex::Params chapterIndex(const LocalizerParams& params) {
  MapIndex::Params index;
  index.cell_m = params.cell_m;
  index.reach_m = kTruncation_m;
  index.build_fields = params.health.use_field;
  index.build_trees = params.health.use_field;
  return index;
}

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
    // The part of the segment inside this row meets the row's vertical lines.
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
    // A corner of a cell is met by two lines at once.
    if (last >= 0.0 && (fraction - last) * length < 0.5) continue;
    points.push_back(px.a + fraction * along);
    last = fraction;
  }
  return points;
}

void ProjectedLines::project(const std::vector<Segment3>& segments_world, const SegmentProjector& projector) {
  lines_.clear();
  for (const Segment3& segment : segments_world) {
    const auto px = projector.unbounded(segment);
    if (!px || !projector.inImage(*px)) continue;
    lines_.emplace_back(*px);
  }
}

double ProjectedLines::distance(const Eigen::Vector2d& px) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const ProjectedLine& line : lines_) nearest = std::min(nearest, line.square(px));
  return std::sqrt(nearest);
}

double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px, ProjectedLines& room) {
  const SegmentProjector projector(intrinsics, T_world_camera);
  const double diagonal = std::hypot(intrinsics.width, intrinsics.height);
  double sum = 0.0;
  int label = -1;
  for (const ImagePoint& point : points) {
    if (point.label != label) room.project(map.segments(label = point.label), projector);
    sum += room.isEmpty() ? diagonal : room.distance(point.px);
  }
  return std::clamp(1.0 - sum / static_cast<double>(points.size()) / scale_px, 0.0, 1.0);
}

double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m) {
  const double most = 2.0 * static_cast<double>(lines.size()) * scale_m;  // with so much the health is 0
  double sum = 0.0;
  // With fields first what is at least known of every end: most places need no more, and those that do need
  // few searches over the whole map.
  if (const auto reach = map.fieldReach()) {
    double least = 0.0;
    for (const RememberedLine& line : lines) {
      const Segment2 world = transform(T_world_robot, line.robot);
      for (const Eigen::Vector2d& end : {world.a, world.b}) {
        const auto near = map.nearest(line.label, end, 0.0);
        least += near ? near->distance_m : *reach;
      }
      if (least >= most) return 0.0;
    }
  }
  for (const RememberedLine& line : lines) {
    const Segment2 world = transform(T_world_robot, line.robot);
    sum += map.distance(line.label, world.a) + map.distance(line.label, world.b);
  }
  return std::clamp(1.0 - sum / most, 0.0, 1.0);
}

void HealthObservation::set(const MemoryUpdate& update) {
  lines_.clear();
  points_.clear();
  pixels_.clear();
  if (params_.source != HealthSource::kImage && update.snapshot) {
    const Pose2 T_robot_odom = inverse(update.snapshot->T_odom_robot);
    for (const MemorySegment& segment : update.snapshot->segments) {
      const auto label = map_.floorLabelId(segment.label);
      if (!label) continue;
      const Segment2 robot = transform(T_robot_odom, segment.odom.floor());
      if (distanceToSegment(Eigen::Vector2d(0.0, 0.0), robot) > params_.memory_range_m) continue;
      lines_.push_back({robot, *label});
    }
  }
  if (params_.source != HealthSource::kMemory && update.analysis) {
    intrinsics_ = update.analysis->intrinsics;
    T_robot_camera_ = update.analysis->T_robot_camera;
    const SamplingGrid grid(intrinsics_.width, intrinsics_.height, params_.grid_top_px,
                            params_.grid_bottom_px);
    for (const ImageSegment& segment : update.analysis->observed) {
      const auto label = map_.labelId(segment.label);
      if (!label) continue;
      for (const Eigen::Vector2d& px : grid.crossings(segment.px)) points_.push_back({px, *label});
    }
    std::stable_sort(points_.begin(), points_.end(),
                     [](const ImagePoint& a, const ImagePoint& b) { return a.label < b.label; });
    for (const ImagePoint& point : points_) pixels_.push_back(point.px);
    squares_.resize(pixels_.size());
  }
}

/// Calls with the tree and the pixels of each label until it says no.
template <typename AddLabel>
void HealthObservation::visitLabels(AddLabel add_label) const {
  for (std::size_t first = 0; first < points_.size();) {
    const int label = points_[first].label;
    std::size_t after = first;
    while (after < points_.size() && points_[after].label == label) ++after;
    if (!add_label(*map_.tree(label), std::span(pixels_).subspan(first, after - first))) return;
    first = after;
  }
}

/// What imageHealth gives; 0 where that is under `least`.
double HealthObservation::healthByTrees(const Pose3& T_world_camera, double scale_px, double least) const {
  const TreeCamera camera(intrinsics_, T_world_camera);
  const double diagonal = std::hypot(intrinsics_.width, intrinsics_.height);
  const auto size = static_cast<double>(points_.size());
  const double most_sum = kCertainlyEnough * (1.0 - least) * size * scale_px;
  double sum = 0.0;
  if (least > 0.0) {
    // Most places show nothing near most points: no need to know how far it is.
    // No further than what a label without a line in view counts.
    const double far_px = std::min(kFarScales * scale_px, diagonal);
    bool is_exact = true;
    visitLabels([&](const SegmentTree& tree, std::span<const Eigen::Vector2d> px) {
      tree.nearestSquares(camera, px, squares_, tree_room_, far_px * far_px);
      for (std::size_t i = 0; i < px.size(); ++i) {
        is_exact = is_exact && squares_[i] < far_px * far_px;
        sum += std::sqrt(squares_[i]);
      }
      return sum <= most_sum;
    });
    if (sum > most_sum) return 0.0;
    if (is_exact) return std::clamp(1.0 - sum / size / scale_px, 0.0, 1.0);
    sum = 0.0;
  }
  visitLabels([&](const SegmentTree& tree, std::span<const Eigen::Vector2d> px) {
    const bool is_in_view = tree.nearestSquares(camera, px, squares_, tree_room_);
    for (std::size_t i = 0; i < px.size(); ++i) sum += is_in_view ? std::sqrt(squares_[i]) : diagonal;
    return sum <= most_sum;
  });
  return sum > most_sum ? 0.0 : std::clamp(1.0 - sum / size / scale_px, 0.0, 1.0);
}

double HealthObservation::health(const Pose2& T_world_robot, double least) const {
  double sum = 0.0;
  int functions = 0;
  if (!lines_.empty()) {
    sum += memoryHealth(lines_, T_world_robot, map_, params_.memory_scale_m);
    ++functions;
  }
  if (!points_.empty()) {
    const double scale_px = params_.image_scale_px * intrinsics_.width / kReferenceWidth_px;
    const Pose3 T_world_camera = toPose3(T_world_robot) * T_robot_camera_;
    sum += map_.tree(points_.front().label)
               ? healthByTrees(T_world_camera, scale_px, functions == 0 ? least : 0.0)
               : imageHealth(points_, intrinsics_, T_world_camera, map_, scale_px, room_);
    ++functions;
  }
  return functions == 0 ? 0.0 : sum / functions;
}

}  // namespace vismem
