#include "localization/core/likelihood/chapter_health.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace vismem {
namespace {

constexpr double kReferenceWidth_px = 320.0;  // image width of the chapter's pixel values

/// Truncation of the fields. Beyond it the search continues in floor cells: it affects speed only.
constexpr double kIndexReach_m = 2.0;

/// Margins of the early exits against rounding of the sums.
constexpr double kCertainlyEnough = 1.000001;
constexpr double kCertainlyLess = 0.999999;
constexpr double kReachRounding_m = 1e-6;

/// Search radii about the points in the image [multiples of L4's M]. Used is the smallest that exceeds
/// kFarMeans times the largest mean distance of a pose above the required health.
constexpr std::array<double, 4> kFloorScales{0.2, 0.4, 0.8, 1.5};
constexpr double kFarMeans = 1.5;
constexpr double kMostFloor_m = 3.0;  // radius; points with a wider footprint are searched by the tree

constexpr std::size_t kLinesAtOnce = 8;  // of the memory, per query of the fields

/// Lower bound of the distance from the pixel to floor lines outside the disc [px].
double reachOf(const PixelFootprint& pixel, const FloorDisc& disc) {
  return pixel.reach(disc.radius_m - (pixel.p_robot() - disc.middle).norm() - kReachRounding_m);
}

}  // namespace

MapIndex::Params chapterIndex(const HealthParams& params, const MapParams& map) {
  MapIndex::Params index;
  index.cell_m = map.cell_m;
  index.reach_m = kIndexReach_m;
  index.build_fields = params.use_field;
  index.build_trees = params.use_field;
  return index;
}

void ProjectedLines::project(const std::vector<Segment3>& segments_world, const SegmentProjector& projector) {
  lines_.clear();
  for (const Segment3& segment : segments_world) {
    const auto px = projector.unbounded(segment);
    if (!px || !projector.isInImage(*px)) continue;
    lines_.emplace_back(*px);
  }
}

double ProjectedLines::distance(const Eigen::Vector2d& px) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const ProjectedLine& line : lines_) nearest = std::min(nearest, line.square(px));
  return std::sqrt(nearest);
}

double imageHealth(const std::vector<ImagePoint>& points, const CameraIntrinsics& intrinsics,
                   const Pose3& T_world_camera, const MapIndex& map, double scale_px,
                   ProjectedLines& buffer) {
  const SegmentProjector projector(intrinsics, T_world_camera);
  const double diagonal = std::hypot(intrinsics.width, intrinsics.height);
  double sum = 0.0;
  int label = -1;
  for (const ImagePoint& point : points) {
    if (point.label != label) buffer.project(map.segments(label = point.label), projector);
    sum += buffer.isEmpty() ? diagonal : buffer.distance(point.px);
  }
  return std::clamp(1.0 - sum / static_cast<double>(points.size()) / scale_px, 0.0, 1.0);
}

double memoryHealth(const std::vector<RememberedLine>& lines, const Pose2& T_world_robot, const MapIndex& map,
                    double scale_m, double least) {
  const double most = 2.0 * static_cast<double>(lines.size()) * scale_m;  // sum at which the health is 0
  const double enough = kCertainlyEnough * (1.0 - least) * most;
  const double cosine = std::cos(T_world_robot.theta);
  const double sine = std::sin(T_world_robot.theta);
  const auto toWorld = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return {T_world_robot.x + cosine * p.x() - sine * p.y(), T_world_robot.y + sine * p.x() + cosine * p.y()};
  };
  double sum = 0.0;
  // The truncated distances of the fields bound the sum from below, which rejects most poses.
  if (const auto reach = map.fieldReach()) {
    std::array<SegmentGrid::Question, 2 * kLinesAtOnce> ends;
    std::array<double, 2 * kLinesAtOnce> squares;
    bool is_exact = true;
    for (std::span<const RememberedLine> left = lines; !left.empty();) {
      const std::size_t count = std::min(kLinesAtOnce, left.size());
      for (std::size_t i = 0; i < count; ++i) {
        ends[2 * i] = map.question(left[i].label, toWorld(left[i].robot.a), 0.0);
        ends[2 * i + 1] = map.question(left[i].label, toWorld(left[i].robot.b), 0.0);
      }
      map.nearestSquares(std::span(ends).first(2 * count), squares);
      for (std::size_t i = 0; i < count; ++i) {
        is_exact = is_exact && std::max(squares[2 * i], squares[2 * i + 1]) < *reach * *reach;
        sum += std::sqrt(squares[2 * i]) + std::sqrt(squares[2 * i + 1]);
      }
      if (sum > enough) return 0.0;
      left = left.subspan(count);
    }
    if (is_exact) return std::clamp(1.0 - sum / most, 0.0, 1.0);
    sum = 0.0;
  }
  for (const RememberedLine& line : lines) {
    sum += map.distance(line.label, toWorld(line.robot.a)) + map.distance(line.label, toWorld(line.robot.b));
    if (sum > enough) return 0.0;
  }
  return std::clamp(1.0 - sum / most, 0.0, 1.0);
}

void HealthObservation::set(const MemoryUpdate& update) {
  lines_.clear();
  points_.clear();
  if (params_.source != ObservationSource::kImage && update.snapshot) {
    const Pose2 T_robot_odom = inverse(update.snapshot->T_odom_robot);
    for (const MemorySegment& segment : update.snapshot->segments) {
      const auto label = map_.floorLabelId(segment.label);
      if (!label) continue;
      const Segment2 robot = transform(T_robot_odom, segment.odom.floor());
      if (distanceToSegment(Eigen::Vector2d(0.0, 0.0), robot) > params_.memory_range_m) continue;
      lines_.push_back({robot, *label});
    }
  }
  if (params_.source != ObservationSource::kMemory && update.analysis) {
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
    prepareFloors();
  }
}

/// The camera at a pose, computed on first use: at many poses nothing is projected.
class HealthObservation::PlacedCamera {
 public:
  PlacedCamera(const CameraIntrinsics& intrinsics, const Pose2& T_world_robot, const Pose3& T_robot_camera)
      : intrinsics_(intrinsics), T_world_robot_(T_world_robot), T_robot_camera_(T_robot_camera) {}

  const Pose2& T_world_robot() const { return T_world_robot_; }
  const SegmentProjector& projector() {
    if (!projector_) projector_.emplace(intrinsics_, T_world_camera());
    return *projector_;
  }
  const TreeCamera& tree() {
    if (!tree_) tree_.emplace(intrinsics_, T_world_camera());
    return *tree_;
  }

 private:
  Pose3 T_world_camera() const { return toPose3(T_world_robot_) * T_robot_camera_; }

  const CameraIntrinsics& intrinsics_;
  const Pose2& T_world_robot_;
  const Pose3& T_robot_camera_;
  std::optional<SegmentProjector> projector_;
  std::optional<TreeCamera> tree_;
};

double HealthObservation::imageScale() const {
  return params_.image_scale_px * intrinsics_.width / kReferenceWidth_px;
}

/// Prepares the search levels: discs of the floor about the points' footprints.
void HealthObservation::prepareFloors() {
  groups_.clear();
  pixels_.clear();
  std::vector<PixelFootprint> footprints;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (i == 0 || points_[i].label != groups_.back().label) groups_.push_back({points_[i].label, i, 0});
    ++groups_.back().count;
    pixels_.push_back(points_[i].px);
    footprints.emplace_back(intrinsics_, T_robot_camera_, points_[i].px);
  }
  squares_.resize(points_.size());
  in_view_.assign(groups_.size(), false);
  diagonal_px_ = std::hypot(intrinsics_.width, intrinsics_.height);
  floors_.resize(kFloorScales.size());
  for (std::size_t level = 0; level < floors_.size(); ++level) {
    Floor& floor = floors_[level];
    floor.within_px = kFloorScales[level] * imageScale();
    floor.discs.assign(groups_.size(), {});
    floor.reach_squares.assign(points_.size(), 0.0);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const Group& group = groups_[g];
      const std::span of_group = std::span(footprints).subspan(group.first, group.count);
      const bool is_floor = map_.floorCells(group.label) != nullptr;
      if (is_floor) floor.discs[g] = floorWithin(of_group, floor.within_px, kMostFloor_m);
      for (std::size_t i = 0; i < group.count; ++i) {
        const double reach_px = is_floor ? reachOf(of_group[i], floor.discs[g]) : floor.within_px;
        // Without a line in view a point counts the diagonal.
        const double most_px = std::min(reach_px, diagonal_px_);
        floor.reach_squares[group.first + i] = kCertainlyLess * most_px * most_px;
      }
    }
  }
}

/// Squared distances of a group's points to the lines on a disc of the floor.
/// @return false if no line is in view.
bool HealthObservation::searchFloor(const Group& group, const FloorDisc& disc, PlacedCamera& place) const {
  const std::span px = std::span(pixels_).subspan(group.first, group.count);
  const std::span squares = std::span(squares_).subspan(group.first, group.count);
  std::fill(squares.begin(), squares.end(), std::numeric_limits<double>::infinity());
  if (disc.radius_m <= 0.0) return false;
  bool is_in_view = false;
  const auto measure = [&](const Segment2& line) {
    const Segment3 world{{line.a.x(), line.a.y(), 0.0}, {line.b.x(), line.b.y(), 0.0}};
    const SegmentProjector& projector = place.projector();
    const auto unbounded = projector.unbounded(world);
    if (!unbounded || !projector.isInImage(*unbounded)) return;
    is_in_view = true;
    const ProjectedLine projected(*unbounded);
    for (std::size_t i = 0; i < px.size(); ++i) squares[i] = std::min(squares[i], projected.square(px[i]));
  };
  map_.floorCells(group.label)
      ->visitNear(transform(place.T_world_robot(), disc.middle), disc.radius_m, measure);
  return is_in_view;
}

/// The same for the lines within a distance in the image.
/// @return false if there are none.
bool HealthObservation::searchNear(const Group& group, const TreeCamera& camera, double within_px) const {
  const std::span px = std::span(pixels_).subspan(group.first, group.count);
  const std::span squares = std::span(squares_).subspan(group.first, group.count);
  const double most_square = within_px * within_px;
  map_.tree(group.label)->nearestSquares(camera, px, squares, tree_buffer_, most_square);
  bool is_near = false;
  for (double& square : squares) {
    is_near = is_near || square < most_square;
    if (!(square < most_square)) square = std::numeric_limits<double>::infinity();
  }
  return is_near;
}

/// Puts the points that need a wider search into open_.
/// @return false if there are none.
bool HealthObservation::gatherOpen(const Group& group, std::span<const double> reach_squares) const {
  open_.numbers.clear();
  open_.pixels.clear();
  open_.squares.clear();
  for (std::size_t i = group.first; i < group.first + group.count; ++i) {
    if (squares_[i] <= reach_squares[i]) continue;
    open_.numbers.push_back(i);
    open_.pixels.push_back(pixels_[i]);
    open_.squares.push_back(squares_[i]);
  }
  return !open_.numbers.empty();
}

void HealthObservation::storeOpen() const {
  for (std::size_t i = 0; i < open_.numbers.size(); ++i) squares_[open_.numbers[i]] = open_.squares[i];
}

/// The value of imageHealth; 0 if it is below `least`.
double HealthObservation::healthByIndex(const Pose2& T_world_robot, double least) const {
  const double scale_px = imageScale();
  const auto size = static_cast<double>(points_.size());
  const double most_mean = (1.0 - least) * scale_px;
  const double most_sum = kCertainlyEnough * size * most_mean;
  const auto healthOf = [&](double sum) { return std::clamp(1.0 - sum / size / scale_px, 0.0, 1.0); };
  PlacedCamera place(intrinsics_, T_world_robot, T_robot_camera_);
  const auto level = std::find_if(floors_.begin(), floors_.end() - 1, [&](const Floor& floor) {
    return floor.within_px >= kFarMeans * most_mean;
  });
  double sum = 0.0;
  bool is_exact = true;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (map_.floorCells(groups_[g].label)) {
      in_view_[g] = searchFloor(groups_[g], level->discs[g], place);
    } else {
      in_view_[g] = searchNear(groups_[g], place.tree(), level->within_px);
    }
    for (std::size_t i = groups_[g].first; i < groups_[g].first + groups_[g].count; ++i) {
      is_exact = is_exact && squares_[i] <= level->reach_squares[i];
      sum += std::sqrt(std::min(squares_[i], level->reach_squares[i]));
    }
    if (sum > most_sum) return 0.0;
  }
  if (is_exact) return healthOf(sum);
  sum = 0.0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Group& group = groups_[g];
    if (gatherOpen(group, level->reach_squares)) {
      in_view_[g] =
          map_.tree(group.label)->lowerSquares(place.tree(), open_.pixels, open_.squares, tree_buffer_) ||
          in_view_[g];
      storeOpen();
    }
    for (std::size_t i = group.first; i < group.first + group.count; ++i) {
      sum += in_view_[g] ? std::sqrt(squares_[i]) : diagonal_px_;
    }
    if (sum > most_sum) return 0.0;
  }
  return healthOf(sum);
}

double HealthObservation::health(const Pose2& T_world_robot, double least) const {
  const double functions = (lines_.empty() ? 0.0 : 1.0) + (points_.empty() ? 0.0 : 1.0);
  if (functions == 0.0) return 0.0;
  // Each function is at most 1, which bounds the other from below.
  const double least_sum = functions * least;
  double sum = 0.0;
  if (!lines_.empty()) {
    sum = memoryHealth(lines_, T_world_robot, map_, params_.memory_scale_m,
                       std::max(0.0, least_sum - (functions - 1.0)));
  }
  if (!points_.empty()) {
    sum += map_.tree(points_.front().label)
               ? healthByIndex(T_world_robot, std::max(0.0, least_sum - sum))
               : imageHealth(points_, intrinsics_, toPose3(T_world_robot) * T_robot_camera_, map_,
                             imageScale(), projected_);
  }
  const double health = sum / functions;
  return health < least ? 0.0 : health;
}

}  // namespace vismem
