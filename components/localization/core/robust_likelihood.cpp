#include "localization/core/robust_likelihood.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/geometry/angles.h"
#include "common/geometry/projection.h"

namespace vismem {
namespace {

constexpr double kTruncation_m = 1.0;          // of the fields: several times the largest sigma with blur
constexpr double kMinimumPlanLength_m = 0.03;  // shorter map segments are vertical edges

/// Image segments are sampled this finely, but in no more pieces than that: a fixed cost per segment.
constexpr double kPiece_px = 6.0;
constexpr int kMaximumPieces = 12;
constexpr double kLongestPiece_m = 0.2;  // towards the horizon pixels stand for ever longer pieces of floor

/// A remembered point lies so much worse than one that is seen now: odometry erred since.
constexpr double kRememberedSigma = 4.0 / 3.0;

/// A line that comes this near to the image's border goes on beyond it.
constexpr double kBorder_px = 3.0;
/// An end is worth at most this share of its segment: what is short may be anything.
constexpr double kEndShare = 0.5;

constexpr double kMinimumLength_m = 0.05;  // a shorter remembered segment has no usable direction

constexpr std::size_t kPreview = 4;  // every n-th point of an observation is a fair sample of all

constexpr std::size_t kBatch = 32;  // points whose surroundings are fetched together

/// Damping where the observation says nothing about a direction: one metre, one radian.
const Matrix5d kDamping = Matrix5d::Identity();

/// A lean that is taken as known is held by this [rad].
constexpr double kFixedLean_rad = 1e-6;

/// A step further than this leaves the part of the field that the gradient describes.
constexpr double kLongestStep_m = 0.5;
constexpr double kLongestTurn_rad = 0.4;
/// And after a step smaller than this the next one changes nothing that anybody could see.
constexpr double kSmallStep_m = 5e-4;
constexpr double kSmallStep_rad = 5e-4;

/// Variance across the segment at one of its ends.
double variancesAcross(const Eigen::Matrix3d& P, const Eigen::Vector2d& along_odom) {
  const Eigen::Vector2d across(-along_odom.y(), along_odom.x());
  return across.dot(P.topLeftCorner<2, 2>() * across);
}

/// How the floor point at `ray` from the camera's foot moves when the camera, `height` above the floor, leans
/// by a small angle about the y axis and about the x axis: the ray turns, and meets the floor elsewhere.
Eigen::Matrix2d movedByLean(const Eigen::Vector2d& ray, double height) {
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

double weightOf(const RobustObservation& observation) {
  double sum = 0.0;
  for (const EvidencePoint& point : observation.points) sum += point.weight;
  return sum;
}

/// Scales the points' weights so that they sum to at most `effective_points`; the amount stays as it was.
void capPoints(RobustObservation& observation, double effective_points) {
  double sum = 0.0;
  for (const EvidencePoint& point : observation.points) sum += point.weight;
  if (sum <= effective_points) return;
  for (EvidencePoint& point : observation.points) point.weight *= effective_points / sum;
}

}  // namespace

MapIndex::Params robustIndex(const LocalizerParams& params) {
  MapIndex::Params index;
  index.cell_m = params.cell_m;
  index.reach_m = kTruncation_m;
  if (params.robust.direction_gate) index.direction_gate_rad = params.robust.direction_gate_rad;
  index.minimum_plan_length_m = kMinimumPlanLength_m;
  index.build_fields = params.robust.use_field;
  return index;
}

RobustObservation observeMemory(const MemorySnapshot& snapshot, const MapIndex& map,
                                const RobustParams& params) {
  RobustObservation observation;
  const Pose2 T_robot_odom = inverse(snapshot.T_odom_robot);
  struct Piece {
    Segment2 robot;
    int label;
    double weight_per_m;
    double variance_a;
    double variance_b;
  };
  std::vector<Piece> pieces;
  double length = 0.0;
  for (const MemorySegment& segment : snapshot.segments) {
    const auto label = map.floorLabelId(segment.label);
    if (!label) continue;
    const Segment2 odom = segment.odom.floor();
    if (odom.length() < kMinimumLength_m) continue;
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(params.range_m);
    const auto robot = clipToBox(transform(T_robot_odom, odom), -reach, reach);
    if (!robot || robot->length() < kMinimumLength_m) continue;
    const double unseen_s =
        std::max(0.0, static_cast<double>(snapshot.stamp_us - segment.last_seen_us) / kSecondUs);
    double weight = params.points_per_metre;
    if (params.half_life_s > 0.0) weight *= std::exp2(-unseen_s / params.half_life_s);
    if (!segment.confirmed) weight *= params.unconfirmed_weight;
    const double drift = params.drift_sigma_mps * unseen_s;
    const double base = std::pow(kRememberedSigma * params.sigma_m, 2) + drift * drift;
    const Eigen::Vector2d along = (odom.b - odom.a).normalized();
    pieces.push_back({*robot, *label, weight, base + variancesAcross(segment.P_a, along),
                      base + variancesAcross(segment.P_b, along)});
    length += robot->length();
  }
  const double step = std::max(params.point_step_m, length / params.maximum_points);
  const double least_variance = std::pow(kRememberedSigma * params.sigma_m, 2);
  const double largest_variance = std::max(least_variance, params.maximum_sigma_m * params.maximum_sigma_m);
  for (const Piece& piece : pieces) {
    const double piece_length = piece.robot.length();
    const int count = std::max(2, static_cast<int>(std::lround(piece_length / step)));
    const double direction = piece.robot.direction();
    const double weight = piece.weight_per_m * piece_length;
    for (int i = 0; i < count; ++i) {
      const double fraction = (i + 0.5) / count;
      EvidencePoint point;
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
  }
  for (const Primitive& primitive : snapshot.primitives) {
    if (primitive.kind != PrimitiveKind::kParallelogram || primitive.vertices.size() != 4) continue;
    auto& corners = observation.parallelograms.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) corners[i] = transform(T_robot_odom, primitive.vertices[i]);
  }
  observation.segment_weight = observation.amount;
  observation.remembered = observation.points.size();
  capPoints(observation, params.effective_points);
  return observation;
}

RobustObservation observeImage(const ImageAnalysis& analysis, const MapIndex& map,
                               const RobustParams& params) {
  RobustObservation observation;
  const Eigen::Vector2d camera = analysis.T_robot_camera.translation().head<2>();
  const double height = analysis.T_robot_camera.translation().z();
  if (!(height > 0.0)) return observation;
  std::vector<EvidencePoint> ends;
  for (const ImageSegment& segment : analysis.observed) {
    ends.clear();
    const auto label = map.floorLabelId(segment.label);
    if (!label) continue;
    const int pieces = std::clamp(static_cast<int>(segment.px.length() / kPiece_px), 1, kMaximumPieces);
    Eigen::Vector2d begin = Eigen::Vector2d::Zero();
    Eigen::Vector2d last = begin;
    bool has_last = false;
    double weight = 0.0;
    for (int i = 0; i <= pieces; ++i) {
      const double fraction = static_cast<double>(i) / pieces;
      const Eigen::Vector2d px = segment.px.a + fraction * (segment.px.b - segment.px.a);
      const auto floor =
          backProjectToGround(analysis.intrinsics, analysis.T_robot_camera, px, params.image_range_m);
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
      EvidencePoint point;
      point.p_robot = piece.middle();
      point.direction_robot = piece.direction();
      point.label = *label;
      // An error of the camera's pitch moves a floor point along the ray, one of its heading across it.
      const Eigen::Vector2d ray = point.p_robot - camera;
      const double range = std::max(ray.norm(), 1e-3);
      const Eigen::Vector2d along = (piece.b - piece.a) / piece.length();
      const double across_ray = std::abs(along.x() * ray.y() - along.y() * ray.x()) / range;
      const double along_ray = std::abs(along.dot(ray)) / range;
      const double std_range = (range * range + height * height) / height * params.camera_sigma_rad;
      const double std_bearing = range * params.camera_sigma_rad;
      point.sigma_m = std::min(params.maximum_sigma_m,
                               std::hypot(params.sigma_m, across_ray * std_range, along_ray * std_bearing));
      point.weight = params.points_per_metre * std::min(piece.length(), kLongestPiece_m);
      point.d_lean = movedByLean(ray, height);
      observation.amount += point.weight;
      weight += point.weight;
      observation.points.push_back(point);
      if (params.end_metres <= 0.0) continue;
      for (const bool first : {true, false}) {
        if (i != (first ? 1 : pieces)) continue;
        if (!insideImage(analysis.intrinsics, first ? segment.px.a : segment.px.b)) continue;
        // Where a line ends tells the place along it; what the camera errs by goes in all directions alike.
        EvidencePoint end = point;
        end.p_robot = first ? piece.a : piece.b;
        end.sigma_m = std::min(params.maximum_sigma_m, std::hypot(params.sigma_m, std_range));
        end.d_lean = movedByLean(end.p_robot - camera, height);
        ends.push_back(end);
      }
    }
    for (EvidencePoint& end : ends) {
      end.weight = std::min(params.points_per_metre * params.end_metres, kEndShare * weight);
      observation.points.push_back(end);
    }
    if (weight == 0.0 || (last - begin).norm() < kMinimumLength_m) continue;
    observation.segments.push_back({{begin, last}, *label, weight});
    observation.segment_weight += weight;
  }
  capPoints(observation, params.effective_points);
  return observation;
}

RobustObservation observe(const MemoryUpdate& update, const MapIndex& map, const RobustParams& params) {
  RobustObservation memory;
  RobustObservation image;
  if (params.source != HealthSource::kImage && update.snapshot) {
    memory = observeMemory(*update.snapshot, map, params);
  }
  if (params.source != HealthSource::kMemory && update.analysis) {
    image = observeImage(*update.analysis, map, params);
  }
  // A covered camera leaves all to the memory, an empty memory all to the image.
  if (!memory.points.empty() && !image.points.empty()) {
    const double memory_share = (1.0 - params.image_share) * std::max(0.0, 1.0 - image.amount / (6.0));
    if (memory_share > 0.0) {
      capPoints(memory, memory_share * params.effective_points);
      capPoints(image, (1.0 - memory_share) * params.effective_points);
    } else {
      memory.points.clear();
      memory.remembered = 0;
    }
  }
  RobustObservation all = std::move(memory);
  all.segments.insert(all.segments.end(), image.segments.begin(), image.segments.end());
  all.segment_weight += image.segment_weight;
  all.points.insert(all.points.end(), image.points.begin(), image.points.end());
  // A race has already been moved by what the memory holds; half as much of an image moves it better.
  if (!image.points.empty()) {
    all.memory_pull = std::max(0.0, 1.0 - 2.0 * image.amount / params.memory_below_points);
  }
  // What the memory has of this image is no second observation for "is there enough to see".
  all.amount = std::max(all.amount, image.amount);
  return all;
}

RobustObservation thinned(const RobustObservation& observation, std::size_t points) {
  const std::size_t stride = (observation.points.size() + points - 1) / std::max<std::size_t>(points, 1);
  if (stride <= 1) return observation;
  RobustObservation few;
  few.amount = observation.amount;
  few.memory_pull = observation.memory_pull;
  few.news = observation.news;
  for (std::size_t i = 0; i < observation.points.size(); i += stride) {
    few.remembered += i < observation.remembered ? 1 : 0;
    few.points.push_back(observation.points[i]);
  }
  const double scale = weightOf(observation) / weightOf(few);
  for (EvidencePoint& point : few.points) point.weight *= scale;
  return few;
}

std::optional<FieldSample> RobustLikelihood::sample(const EvidencePoint& point,
                                                    const Eigen::Vector2d& p_world, double heading) const {
  const double direction = point.direction_robot + heading;
  return params_.use_field ? map_.nearest(point.label, p_world, direction)
                           : map_.nearestBruteForce(point.label, p_world, direction);
}

double RobustLikelihood::squareAt(const EvidencePoint& point, const Eigen::Vector2d& p_world,
                                  double heading) const {
  const double direction = point.direction_robot + heading;
  if (params_.use_field) return map_.nearestSquare(point.label, p_world, direction);
  const auto nearest = map_.nearestBruteForce(point.label, p_world, direction);
  return nearest ? nearest->distance_m * nearest->distance_m : kTruncation_m * kTruncation_m;
}

void RobustLikelihood::fetch(const RobustObservation& observation, const Placement& placement) const {
  const Pose2& pose = placement.T_world_robot;
  const Eigen::Rotation2Dd R(pose.theta);
  const Eigen::Vector2d lean = placement.lean();
  std::array<Eigen::Vector2d, kBatch> places;
  for (std::span points(observation.points); !points.empty();) {
    const std::size_t count = std::min(kBatch, points.size());
    for (std::size_t i = 0; i < count; ++i) {
      places[i] = pose.position() + R * (points[i].p_robot + points[i].d_lean * lean);
    }
    map_.fetch(std::span(places).first(count));
    points = points.subspan(count);
  }
}

void RobustLikelihood::add(Rating& rating, const EvidencePoint& point,
                           const std::optional<FieldSample>& field, double blur_m) const {
  const double eps = params_.outlier_share;
  const double variance = point.sigma_m * point.sigma_m + blur_m * blur_m;
  const auto addTerm = [&](double log_likelihood) {
    rating.log_likelihood += point.weight * log_likelihood;
    rating.news += point.weight * point.news * log_likelihood;
  };
  if (!field) {
    addTerm(params_.bounded ? log_outlier_share_ : -0.5 * kTruncation_m * kTruncation_m / variance);
    return;
  }
  const double loss = -0.5 * field->distance_m * field->distance_m / variance;
  const double agreement = std::exp(loss);
  addTerm(params_.bounded ? std::log((1.0 - eps) * agreement + eps) : loss);
  rating.explained += point.weight * agreement;
}

Rating RobustLikelihood::rate(const RobustObservation& observation, const Placement& placement,
                              double blur_m) const {
  fetch(observation, placement);
  const Pose2& T_world_robot = placement.T_world_robot;
  const Eigen::Vector2d lean = placement.lean();
  Rating rating;
  const double c = std::cos(T_world_robot.theta);
  const double s = std::sin(T_world_robot.theta);
  for (const EvidencePoint& point : observation.points) {
    const Eigen::Vector2d p_robot = point.p_robot + point.d_lean * lean;
    const Eigen::Vector2d p(T_world_robot.x + c * p_robot.x() - s * p_robot.y(),
                            T_world_robot.y + s * p_robot.x() + c * p_robot.y());
    add(rating, point, sample(point, p, T_world_robot.theta), blur_m);
  }
  if (!observation.points.empty()) rating.explained /= weightOf(observation);
  rating.news /= observation.news;
  return rating;
}

double RobustLikelihood::explained(const RobustObservation& observation, const Pose2& T_world_robot,
                                   double blur_m, double least) const {
  const double c = std::cos(T_world_robot.theta);
  const double s = std::sin(T_world_robot.theta);
  double weight = 0.0;
  double explained = 0.0;
  std::array<Eigen::Vector2d, kBatch> places;
  const std::size_t size = observation.points.size();
  for (std::size_t begin = 0; begin < kPreview; ++begin) {
    for (std::size_t first = begin; first < size; first += kBatch * kPreview) {
      std::size_t count = 0;
      for (std::size_t i = first; i < size && count < kBatch; i += kPreview) {
        const Eigen::Vector2d& p_robot = observation.points[i].p_robot;
        places[count++] = {T_world_robot.x + c * p_robot.x() - s * p_robot.y(),
                           T_world_robot.y + s * p_robot.x() + c * p_robot.y()};
      }
      map_.fetch(std::span(places).first(count));
      for (std::size_t i = 0; i < count; ++i) {
        const EvidencePoint& point = observation.points[first + i * kPreview];
        weight += point.weight;
        const double square = squareAt(point, places[i], T_world_robot.theta);
        if (square >= kTruncation_m * kTruncation_m) continue;
        const double variance = point.sigma_m * point.sigma_m + blur_m * blur_m;
        explained += point.weight * std::exp(-0.5 * square / variance);
      }
    }
    if (begin == 0 && explained < 0.5 * least * weight) return 0.0;
  }
  return weight > 0.0 ? explained / weight : 0.0;
}

/// Quadratic form of -share * log L around a placement, in (x, y, theta, lean).
struct RobustLikelihood::Curvature {
  Matrix5d H = Matrix5d::Zero();
  Vector5d g = Vector5d::Zero();
};

RobustLikelihood::Curvature RobustLikelihood::curvature(std::span<const EvidencePoint> points,
                                                        const Placement& placement, double share,
                                                        double blur_m, Rating* rating) const {
  Curvature result;
  const double eps = params_.outlier_share;
  const Pose2& pose = placement.T_world_robot;
  const Eigen::Vector2d lean = placement.lean();
  Eigen::Matrix2d R;
  R << std::cos(pose.theta), -std::sin(pose.theta), std::sin(pose.theta), std::cos(pose.theta);
  for (const EvidencePoint& point : points) {
    const Eigen::Vector2d arm = R * (point.p_robot + point.d_lean * lean);
    const auto field = sample(point, pose.position() + arm, pose.theta);
    if (rating) add(*rating, point, field, blur_m);
    if (!field) continue;
    const double variance = point.sigma_m * point.sigma_m + blur_m * blur_m;
    const double inlier = (1.0 - eps) * std::exp(-0.5 * field->distance_m * field->distance_m / variance);
    // Derivative of the bounded loss: far points pull less and less.
    const double influence = params_.bounded ? inlier / (inlier + eps) : 1.0;
    const double weight = share * point.weight / variance * influence;
    const Eigen::Vector2d& gradient = field->gradient;
    Vector5d J;
    J.head<2>() = gradient;
    J[2] = gradient.y() * arm.x() - gradient.x() * arm.y();
    J.tail<2>() = point.d_lean.transpose() * (R.transpose() * gradient);
    result.H += weight * J * J.transpose();
    result.g += weight * field->distance_m * J;
  }
  return result;
}

/// The memory may be shifted and turned as a whole: what it says about the pose is worth no more than that.
void RobustLikelihood::soften(Curvature& memory) const {
  if (params_.memory_shift_m <= 0.0 && params_.memory_turn_rad <= 0.0) return;
  const double shift = std::max(params_.memory_shift_m, 1e-6);
  const double turn = std::max(params_.memory_turn_rad, 1e-6);
  const Eigen::Vector3d known(1.0 / (shift * shift), 1.0 / (shift * shift), 1.0 / (turn * turn));
  const Eigen::Matrix3d H = memory.H.topLeftCorner<3, 3>();
  // Marginalising a shift that moves the points just as the pose does.
  const Eigen::Matrix3d kept =
      Eigen::Matrix3d::Identity() - H * (H + Eigen::Matrix3d(known.asDiagonal())).inverse();
  memory.H.topLeftCorner<3, 3>() = kept * H;
  memory.g.head<3>() = (kept * memory.g.head<3>()).eval();
}

RobustLikelihood::Refined RobustLikelihood::refine(const RobustObservation& observation,
                                                   const Placement& start, const Matrix5d& prior_information,
                                                   double share, int steps, double blur_m) const {
  Refined result{start, Matrix5d::Zero(), {}};
  Placement& at = result.placement;
  const double sway = std::max(params_.lean_sway_rad, kFixedLean_rad);
  const Eigen::Matrix2d sway_information = Eigen::Matrix2d::Identity() / (sway * sway);
  const std::span points(observation.points);
  const std::span remembered = points.first(observation.remembered);
  fetch(observation, start);
  // One pass more than steps: the last one only takes the curvature at the result.
  for (int step = 0; step <= steps; ++step) {
    Rating* const rating = step == steps ? &result.rating : nullptr;
    Curvature curve;
    if (observation.memory_pull > 0.0 || rating) {
      // A memory that repeats itself makes no race surer of what odometry did meanwhile.
      curve = curvature(remembered, at, observation.memory_pull * share * observation.news, blur_m, rating);
      soften(curve);
    }
    const Curvature seen = curvature(points.subspan(observation.remembered), at, share, blur_m, rating);
    curve.H += seen.H;
    curve.g += seen.g;
    // The sway moves the points as the lasting lean does: the same columns, and a prior of its own.
    const Eigen::Matrix<double, 5, 2> cross = curve.H.rightCols<2>();
    const Eigen::Matrix2d sway_covariance = (curve.H.bottomRightCorner<2, 2>() + sway_information).inverse();
    const Eigen::Vector2d sway_gradient = curve.g.tail<2>() + sway_information * at.lean_sway;
    result.information = curve.H - cross * sway_covariance * cross.transpose();
    if (step == steps) break;
    Vector5d off;
    off << at.T_world_robot.x - start.T_world_robot.x, at.T_world_robot.y - start.T_world_robot.y,
        angleDifference(at.T_world_robot.theta, start.T_world_robot.theta), at.lean_bias - start.lean_bias;
    const Matrix5d A = result.information + prior_information + kDamping;
    Vector5d move =
        -A.ldlt().solve(curve.g - cross * sway_covariance * sway_gradient + prior_information * off);
    const double length = move.head<2>().norm();
    const double shrink = std::min({1.0, kLongestStep_m / std::max(length, 1e-12),
                                    kLongestTurn_rad / std::max(std::abs(move[2]), 1e-12)});
    move *= shrink;
    const Pose2& pose = at.T_world_robot;
    at.T_world_robot = {pose.x + move[0], pose.y + move[1], wrapAngle(pose.theta + move[2])};
    at.lean_bias += move.tail<2>();
    at.lean_sway -= sway_covariance * (shrink * sway_gradient + cross.transpose() * move);
    if (move.head<2>().norm() < kSmallStep_m && std::abs(move[2]) < kSmallStep_rad) steps = step + 1;
  }
  if (!points.empty()) result.rating.explained /= weightOf(observation);
  result.rating.news /= observation.news;
  return result;
}

}  // namespace vismem
