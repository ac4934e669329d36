#include "localization/core/observation/floor_observation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kPointStep_m = 0.10;       // spacing of sampling points along remembered segments
constexpr double kUnconfirmedWeight = 0.4;  // factor of elements seen from one viewpoint only (M1)

/// Length of the pieces of an image segment, and their largest number, which bounds the cost per segment.
constexpr double kPiece_px = 6.0;
constexpr int kMaximumPieces = 12;
constexpr double kLongestPiece_m = 0.2;  // near the horizon one pixel covers metres of floor

/// An end this near to the image border counts as cut by it.
constexpr double kBorder_px = 3.0;
/// Largest weight of an end relative to its segment: short segments are often false.
constexpr double kEndShare = 0.5;

constexpr double kMinimumLength_m = 0.05;  // a shorter remembered segment has no usable direction

/// Variance across the segment at one of its ends.
double variancesAcross(const Eigen::Matrix3d& P, const Eigen::Vector2d& along_odom) {
  const Eigen::Vector2d across(-along_odom.y(), along_odom.x());
  return across.dot(P.topLeftCorner<2, 2>() * across);
}

/// Derivative of a floor point by small rotations of the camera about the y axis and the x axis.
/// @param ray from the camera's foot point to the floor point [m].
/// @param height of the camera above the floor [m].
Eigen::Matrix2d movedByTilt(const Eigen::Vector2d& ray, double height) {
  const double x = ray.x();
  const double y = ray.y();
  Eigen::Matrix2d d;
  d << -height - x * x / height, x * y / height,  //
      -x * y / height, height + y * y / height;
  return d;
}

bool insideImage(const CameraIntrinsics& intrinsics, const Eigen::Vector2d& px) {
  return px.x() > kBorder_px && px.y() > kBorder_px && px.x() < intrinsics.width - 1.0 - kBorder_px &&
         px.y() < intrinsics.height - 1.0 - kBorder_px;
}

/// Whether the map has edges that a point may show.
bool isMapped(const FloorPoint& point, const MapIndex& map) {
  const auto& levels = map.levels(point.label);
  return std::any_of(levels.begin(), levels.end(),
                     [&](const MapIndex::Level& level) { return point.mayLieAt(level.height_m); });
}

/// Whether the memory knows that an observed segment is off the floor.
bool isOffFloor(const ImageAnalysis& analysis, std::size_t observed) {
  return std::any_of(analysis.matches.begin(), analysis.matches.end(),
                     [&](const ImageAnalysis::Match& match) {
                       return static_cast<std::size_t>(match.observed) == observed &&
                              analysis.predicted[static_cast<std::size_t>(match.predicted)].off_floor;
                     });
}

/// Scales the points' weights so that they sum to at most `effective_points`.
void capPoints(std::span<FloorPoint> points, double effective_points) {
  double sum = 0.0;
  for (const FloorPoint& point : points) sum += point.weight;
  if (sum <= effective_points) return;
  for (FloorPoint& point : points) point.weight *= effective_points / sum;
}

/// A remembered segment in the robot's frame.
struct Piece {
  Segment2 robot;
  int label;
  double weight_per_m;
  double variance_a;  ///< across it at its ends
  double variance_b;
};

/// Calls use(piece) for each remembered segment that counts.
template <typename Use>
void forEachPiece(const MemorySnapshot& snapshot, const MapIndex& map, const ObservationParams& params,
                  const Use& use) {
  const Pose2 T_robot_odom = inverse(snapshot.T_odom_robot);
  for (const MemorySegment& segment : snapshot.segments) {
    const auto label = map.floorLabelId(segment.label);
    if (!label || segment.off_floor) continue;
    const Segment2 odom = segment.odom.floor();
    if (odom.length() < kMinimumLength_m) continue;
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(params.range_m);
    const auto robot = clipToBox(transform(T_robot_odom, odom), -reach, reach);
    if (!robot || robot->length() < kMinimumLength_m) continue;
    const double unseen_s =
        std::max(0.0, static_cast<double>(snapshot.stamp_us - segment.last_seen_us) / kSecondUs);
    double weight = kPointsPerMetre;
    if (params.half_life_s > 0.0) weight *= std::exp2(-unseen_s / params.half_life_s);
    if (!segment.confirmed) weight *= kUnconfirmedWeight;
    const double drift = params.drift_sigma_mps * unseen_s;
    const double base = params.remembered_sigma_m * params.remembered_sigma_m + drift * drift;
    const Eigen::Vector2d along = (odom.b - odom.a).normalized();
    use(Piece{*robot, *label, weight, base + variancesAcross(segment.P_a, along),
              base + variancesAcross(segment.P_b, along)});
  }
}

/// Adds the memory to an empty observation.
void addMemory(FloorObservation& observation, const MemorySnapshot& snapshot, const MapIndex& map,
               const ObservationParams& params) {
  double length = 0.0;
  forEachPiece(snapshot, map, params, [&](const Piece& piece) { length += piece.robot.length(); });
  const double step = std::max(kPointStep_m, length / kMaximumPoints);
  const double least_variance = params.remembered_sigma_m * params.remembered_sigma_m;
  const double largest_variance = std::max(least_variance, kMaximumSigma_m * kMaximumSigma_m);
  forEachPiece(snapshot, map, params, [&](const Piece& piece) {
    const double piece_length = piece.robot.length();
    const int count = std::max(2, static_cast<int>(std::lround(piece_length / step)));
    const double direction = piece.robot.direction();
    const double weight = piece.weight_per_m * piece_length;
    for (int i = 0; i < count; ++i) {
      const double fraction = (i + 0.5) / count;
      FloorPoint point;
      point.p_robot = piece.robot.a + fraction * (piece.robot.b - piece.robot.a);
      point.direction_robot = direction;
      point.label = piece.label;
      const double variance = piece.variance_a + fraction * (piece.variance_b - piece.variance_a);
      point.sigma_m = std::sqrt(std::clamp(variance, least_variance, largest_variance));
      point.weight = weight / count;
      observation.points.push_back(point);
    }
    observation.segments.push_back({piece.robot, piece.label, weight});
    observation.amount += weight;
  });
  observation.segment_weight = observation.amount;
  observation.remembered = observation.points.size();
  capPoints(observation.points, params.effective_points);
}

/// Standard deviation of a floor point along its ray [m].
double stdOfRange(double range, double height, const ObservationParams& params) {
  return (range * range + height * height) / height * params.camera_sigma_rad;
}

/// Places a point of an image at the middle of its piece.
void place(FloorPoint& point, const Segment2& piece, double height, const ObservationParams& params) {
  point.p_robot = piece.middle();
  point.direction_robot = piece.direction();
  // A pitch error moves a floor point along the ray, a heading error across it.
  const Eigen::Vector2d ray = point.p_robot - point.camera_robot;
  const double range = std::max(ray.norm(), 1e-3);
  const Eigen::Vector2d along = (piece.b - piece.a) / piece.length();
  const double across_ray = std::abs(along.x() * ray.y() - along.y() * ray.x()) / range;
  const double along_ray = std::abs(along.dot(ray)) / range;
  const double std_bearing = range * params.camera_sigma_rad;
  point.sigma_m = std::min(
      kMaximumSigma_m,
      std::hypot(params.sigma_m, across_ray * stdOfRange(range, height, params), along_ray * std_bearing));
  point.weight = kPointsPerMetre * std::min(piece.length(), kLongestPiece_m);
  point.d_tilt = movedByTilt(ray, height);
}

/// An end fixes the position along its line; the camera's error is isotropic there.
/// @param point of the piece that ends there.
FloorPoint endOf(FloorPoint point, const Eigen::Vector2d& end, double height,
                 const ObservationParams& params) {
  const double range = std::max((point.p_robot - point.camera_robot).norm(), 1e-3);
  point.p_robot = end;
  point.sigma_m = std::min(kMaximumSigma_m, std::hypot(params.sigma_m, stdOfRange(range, height, params)));
  point.d_tilt = movedByTilt(end - point.camera_robot, height);
  return point;
}

/// Adds the points of an image. @return their weight before the bound.
double addImage(FloorObservation& observation, const ImageAnalysis& analysis, const MapIndex& map,
                const ObservationParams& params, const CameraModel* corrected) {
  const CameraIntrinsics& intrinsics = corrected ? corrected->intrinsics : analysis.intrinsics;
  const Pose3& T_robot_camera = corrected ? corrected->T_robot_camera : analysis.T_robot_camera;
  const double height = T_robot_camera.translation().z();
  if (!(height > 0.0)) return 0.0;
  const std::size_t first_point = observation.points.size();
  double amount = 0.0;
  double segment_weight = 0.0;
  for (std::size_t observed = 0; observed < analysis.observed.size(); ++observed) {
    const ImageSegment& segment = analysis.observed[observed];
    const auto label = map.labelId(segment.label);
    if (!label) continue;
    FloorPoint point;
    point.label = *label;
    point.camera_robot = T_robot_camera.translation().head<2>();
    point.per_camera_height = 1.0 / height;
    point.off_floor = isOffFloor(analysis, observed);
    if (!isMapped(point, map)) continue;
    const int pieces = std::clamp(static_cast<int>(segment.px.length() / kPiece_px), 1, kMaximumPieces);
    Eigen::Vector2d begin = Eigen::Vector2d::Zero();
    Eigen::Vector2d last = begin;
    bool has_last = false;
    double weight = 0.0;
    std::array<FloorPoint, 2> ends;
    std::size_t end_count = 0;
    for (int i = 0; i <= pieces; ++i) {
      const double fraction = static_cast<double>(i) / pieces;
      const Eigen::Vector2d px = segment.px.a + fraction * (segment.px.b - segment.px.a);
      const auto floor = backProjectToGround(intrinsics, T_robot_camera, px, params.image_range_m);
      if (!floor) {
        has_last = false;
        continue;
      }
      const Segment2 piece{last, floor->head<2>()};
      const bool is_piece = has_last && piece.length() >= 1e-3;
      last = piece.b;
      has_last = true;
      if (!is_piece) continue;
      if (weight == 0.0) begin = piece.a;
      place(point, piece, height, params);
      amount += point.weight;
      weight += point.weight;
      observation.points.push_back(point);
      if (params.end_metres <= 0.0) continue;
      for (const bool first : {true, false}) {
        if (i != (first ? 1 : pieces)) continue;
        if (!insideImage(intrinsics, first ? segment.px.a : segment.px.b)) continue;
        ends[end_count++] = endOf(point, first ? piece.a : piece.b, height, params);
      }
    }
    for (FloorPoint& end : std::span(ends).first(end_count)) {
      end.weight = std::min(kPointsPerMetre * params.end_metres, kEndShare * weight);
      observation.points.push_back(end);
    }
    if (point.off_floor || weight == 0.0 || (last - begin).norm() < kMinimumLength_m) continue;
    observation.segments.push_back({{begin, last}, *label, weight});
    segment_weight += weight;
  }
  observation.segment_weight += segment_weight;
  capPoints(std::span(observation.points).subspan(first_point), params.effective_points);
  return amount;
}

/// Without content, but with the memory that it occupies.
FloorObservation emptied(FloorObservation observation) {
  observation.points.clear();
  observation.segments.clear();
  return {std::move(observation.points), 0, std::move(observation.segments)};
}

}  // namespace

double weightOf(const FloorObservation& observation) {
  double sum = 0.0;
  for (const FloorPoint& point : observation.points) sum += point.weight;
  return sum;
}

FloorObservation observeMemory(const MemorySnapshot& snapshot, const MapIndex& map,
                               const ObservationParams& params) {
  FloorObservation observation;
  addMemory(observation, snapshot, map, params);
  return observation;
}

FloorObservation observeImage(const ImageAnalysis& analysis, const MapIndex& map,
                              const ObservationParams& params, const CameraModel* view,
                              FloorObservation reused) {
  FloorObservation observation = emptied(std::move(reused));
  observation.amount = addImage(observation, analysis, map, params, view);
  return observation;
}

FloorObservation observe(const MemoryUpdate& update, const MapIndex& map, const ObservationParams& params,
                         const CameraModel* view, FloorObservation reused) {
  FloorObservation all = emptied(std::move(reused));
  double image_amount = 0.0;
  if (params.source != ObservationSource::kImage && update.snapshot) {
    addMemory(all, *update.snapshot, map, params);
  }
  if (params.source != ObservationSource::kMemory && update.analysis) {
    image_amount = addImage(all, *update.analysis, map, params, view);
  }
  const std::span points(all.points);
  const bool has_image = points.size() > all.remembered;
  // With an occluded camera the memory counts alone, with an empty memory the image.
  if (all.remembered > 0 && has_image) {
    const double memory_share =
        (1.0 - params.image_share) * std::max(0.0, 1.0 - image_amount / params.memory_below_points);
    if (memory_share > 0.0) {
      capPoints(points.first(all.remembered), memory_share * params.effective_points);
      capPoints(points.subspan(all.remembered), (1.0 - memory_share) * params.effective_points);
    } else {
      all.points.erase(all.points.begin(), all.points.begin() + static_cast<std::ptrdiff_t>(all.remembered));
      all.remembered = 0;
    }
  }
  // The races have been refined with the memory's content before; the image is the better source from half
  // of that amount on.
  if (has_image) all.memory_influence = std::max(0.0, 1.0 - 2.0 * image_amount / params.memory_below_points);
  // The memory repeats this image: the amount is the larger of both, not the sum.
  all.amount = std::max(all.amount, image_amount);
  return all;
}

FloorObservation thinned(const FloorObservation& observation, std::size_t points, FloorObservation reused) {
  const std::size_t stride = std::max<std::size_t>((observation.points.size() + points - 1) / points, 1);
  FloorObservation few = emptied(std::move(reused));
  few.amount = observation.amount;
  few.memory_influence = observation.memory_influence;
  for (std::size_t i = 0; i < observation.points.size(); i += stride) {
    few.remembered += i < observation.remembered ? 1 : 0;
    few.points.push_back(observation.points[i]);
  }
  if (stride == 1) return few;
  const double scale = weightOf(observation) / weightOf(few);
  for (FloorPoint& point : few.points) point.weight *= scale;
  return few;
}

void ObservationParams::visit(ParameterVisitor& v) {
  v.real(expert("ImageShare", "share of the image in the observation where image and memory have points"),
         image_share, 0.0, 1.0);
  v.angle(expert("CameraSigma_deg", "error of the camera's direction, for each point on the floor (sigma)"),
          camera_sigma_rad, 0.0, 20.0);
  v.real(expert("HalfLife_s", "time unseen that halves the weight of a remembered segment; 0: never"),
         half_life_s, 0.0, 1e6);
  v.real(expert("Sigma_m", "least error of a point of the image across its line (sigma)"), sigma_m, 0.001,
         kMaximumSigma_m);
  v.real(expert("RememberedSigma_m", "the same of a remembered point"), remembered_sigma_m, 0.001,
         kMaximumSigma_m);
  v.real(expert("DriftSigma_mps", "growth of that error with time unseen"), drift_sigma_mps, 0.0, 10.0);
}

}  // namespace vismem
