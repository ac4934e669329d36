#include "experiments/trials/synthetic_vision.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/projection.h"
#include "experiments/trials/gaussian.h"

namespace vismem {
namespace {

/// A state that old says nothing about the present.
constexpr double kForgotten_s = 1.0;
constexpr double kImage_s = 0.1;  // the time over which `persistence` is given
constexpr double kOnFloor_m = 0.02;
constexpr double kShortestFalse_px = 12.0;
constexpr double kClutterReach_m = 4.0;
constexpr double kShortestClutter_m = 0.3;
constexpr double kLongestClutter_m = 1.5;
/// Edges of average contrast.
constexpr double kStrength = 40.0;

/// Of Student's t of two degrees of freedom, the value that is as rare as this one of a standard normal.
double studentOfTwo(double normal) {
  const double below = 0.5 * std::erfc(-normal / std::numbers::sqrt2);
  const double above = 0.5 * std::erfc(normal / std::numbers::sqrt2);
  return (below - above) / std::sqrt(2.0 * below * above);
}

bool isOnFloor(const MapSegment& edge) {
  return std::abs(edge.world.a.z()) <= kOnFloor_m && std::abs(edge.world.b.z()) <= kOnFloor_m;
}

}  // namespace

SyntheticVision::SyntheticVision(const SegmentMap& edges, const VisionErrors& errors,
                                 const Disturbance& disturbance, std::uint64_t seed)
    : edges_(edges), errors_(errors), disturbance_(disturbance), engine_(seed) {
  for (const MapSegment& edge : edges_.segments) {
    if (isOnFloor(edge) && edge.label != kAnyLabel) floor_labels_.push_back(edge.label);
  }
}

const Label& SyntheticVision::anyLabel() {
  return floor_labels_.empty() ? kUnknownLabel : floor_labels_[pick(engine_, floor_labels_.size())];
}

Eigen::Vector2d SyntheticVision::anyPixel(const CameraIntrinsics& intrinsics) {
  // Two statements: the order of evaluation of arguments is not defined, and runs must repeat.
  const double u = uniform(engine_, 0.0, intrinsics.width - 1.0);
  const double v = uniform(engine_, 0.0, intrinsics.height - 1.0);
  return {u, v};
}

std::vector<ImageSegment> SyntheticVision::look(double time_s, const CameraIntrinsics& intrinsics,
                                                const Pose3& T_world_camera, const CastRay& cast) {
  std::vector<ImageSegment> image;
  for (const VisiblePiece& piece : visiblePieces(edges_, intrinsics, T_world_camera, cast)) {
    addPiece(time_s, intrinsics, piece, image);
  }
  double expected = errors_.false_per_image;
  for (; uniform(engine_, 0.0, 1.0) < expected; expected -= 1.0) addFalse(intrinsics, image);
  addClutter(time_s, intrinsics, T_world_camera, image);
  loseSegments(disturbance_, engine_, image);
  return image;
}

void SyntheticVision::addPiece(double time_s, const CameraIntrinsics& intrinsics, const VisiblePiece& piece,
                               std::vector<ImageSegment>& image) {
  EdgeState& state = states_[piece.edge];
  const double past_s = time_s - state.time_s;
  const auto goOn = [this](double& value, double kept) {
    value = kept * value + std::sqrt(1.0 - kept * kept) * standardNormal(engine_);
  };
  goOn(state.luck, past_s > kForgotten_s ? 0.0 : std::pow(errors_.persistence, past_s / kImage_s));
  for (double* value : {&state.across, &state.along_a, &state.along_b}) {
    goOn(*value, std::exp(-past_s / errors_.lasting_s));
  }
  state.time_s = time_s;
  const MapSegment& edge = edges_.segments[static_cast<std::size_t>(piece.edge)];
  const bool on_floor = isOnFloor(edge);
  const double length = piece.px.length();
  const double p_found = errors_.found / (1.0 + std::exp((errors_.half_px - length) / errors_.soft_px));
  // Of a standard normal, the share below its value is uniform.
  const double luck = 0.5 * std::erfc(-state.luck / std::numbers::sqrt2);
  // Drawn in any case: one more or less must not change all that follows.
  const auto error = [this](const VisionErrors::Spread& spread, double lasting) {
    return spread.lasting_px * lasting + spread.fresh_px * standardNormal(engine_);
  };
  const auto& across_spread = on_floor ? errors_.across_floor : errors_.across_upright;
  const double aside_a = error(across_spread, state.across);
  const double aside_b = error(across_spread, state.across);
  const auto alongFloor = [&](double lasting) {
    const VisionErrors::HeavySpread& spread = errors_.along_floor;
    const double normal = std::sqrt(spread.lasting_share) * lasting +
                          std::sqrt(1.0 - spread.lasting_share) * standardNormal(engine_);
    const double off_px = spread.scale_px[VisionStatistics::rangeBin(piece.range_m)] * studentOfTwo(normal);
    return errors_.along_floor_median_px + std::clamp(off_px, -spread.most_px, spread.most_px);
  };
  const auto beyond = [&](double lasting) {
    return on_floor ? alongFloor(lasting)
                    : errors_.along_upright_mean_px + error(errors_.along_upright, lasting);
  };
  double beyond_a = beyond(state.along_a);
  double beyond_b = beyond(state.along_b);
  if (isAtBorder(intrinsics, piece.px.a)) beyond_a = -errors_.border_px;
  if (isAtBorder(intrinsics, piece.px.b)) beyond_b = -errors_.border_px;
  const bool is_unknown = uniform(engine_, 0.0, 1.0) < errors_.unknown;
  if (luck > p_found) return;

  const Eigen::Vector2d along = (piece.px.b - piece.px.a) / length;
  const Eigen::Vector2d across(along.y(), -along.x());
  const Segment2 found{piece.px.a - beyond_a * along + aside_a * across,
                       piece.px.b + beyond_b * along + aside_b * across};
  if ((found.b - found.a).dot(along) < errors_.least_px) return;
  const Label& label = is_unknown ? kUnknownLabel : edge.label;
  const double broken_every_px = on_floor ? errors_.floor_broken_every_px : errors_.upright_broken_every_px;
  double begin = 0.0;
  const double end = found.length();
  while (begin < end) {
    double stop = end;
    if (broken_every_px > 0.0) {
      stop = std::min(end, begin - broken_every_px * std::log(1.0 - uniform(engine_, 0.0, 1.0)));
    }
    if (stop - begin >= errors_.least_px) {
      const Eigen::Vector2d d = (found.b - found.a) / end;
      image.push_back({{found.a + begin * d, found.a + stop * d}, label, kStrength});
    }
    begin = stop + errors_.gap_px;
  }
}

void SyntheticVision::addFalse(const CameraIntrinsics& intrinsics, std::vector<ImageSegment>& image) {
  const Eigen::Vector2d a = anyPixel(intrinsics);
  const double direction = uniform(engine_, -std::numbers::pi, std::numbers::pi);
  const double length = uniform(engine_, kShortestFalse_px, errors_.longest_false_px);
  const Label& label = anyLabel();
  const auto inside =
      clipToBox({a, a + length * Eigen::Vector2d(std::cos(direction), std::sin(direction))},
                Eigen::Vector2d::Zero(), Eigen::Vector2d(intrinsics.width - 1.0, intrinsics.height - 1.0));
  if (inside && inside->length() >= errors_.least_px) image.push_back({*inside, label, kStrength});
}

void SyntheticVision::addClutter(double time_s, const CameraIntrinsics& intrinsics,
                                 const Pose3& T_world_camera, std::vector<ImageSegment>& image) {
  const double share = disturbance_.false_share;
  if (!(share > 0.0)) return;
  std::erase_if(clutter_, [&](const Clutter& one) { return one.until_s <= time_s; });
  const auto labelled =
      std::count_if(image.begin(), image.end(), [](const auto& one) { return one.label != kUnknownLabel; });
  // As many false ones that the odds are as asked for; the fraction is drawn.
  const double wanted = share / (1.0 - share) * static_cast<double>(labelled);
  auto left = static_cast<int>(wanted);
  if (uniform(engine_, 0.0, 1.0) < wanted - left) ++left;
  const auto show = [&](const Clutter& one) {
    if (left <= 0) return;
    const auto px = projectSegment(intrinsics, T_world_camera, one.world);
    if (!px || px->length() < errors_.least_px) return;
    image.push_back({*px, one.label, kStrength});
    --left;
  };
  for (const Clutter& one : clutter_) show(one);
  // An image that looks over the floor has no place for more.
  for (int tries = 4 * left; left > 0 && tries > 0; --tries) {
    const Eigen::Vector2d px = anyPixel(intrinsics);
    const double direction = uniform(engine_, -std::numbers::pi, std::numbers::pi);
    const double length = uniform(engine_, kShortestClutter_m, kLongestClutter_m);
    const double lasts = -disturbance_.clutter_s * std::log(1.0 - uniform(engine_, 0.0, 1.0));
    const auto floor = backProjectToGround(intrinsics, T_world_camera, px, kClutterReach_m);
    if (!floor) continue;
    const Eigen::Vector3d half =
        0.5 * length * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0);
    clutter_.push_back({{*floor - half, *floor + half}, anyLabel(), time_s + lasts});
    show(clutter_.back());
  }
}

void loseSegments(const Disturbance& disturbance, RandomEngine& engine, std::vector<ImageSegment>& image) {
  if (!(disturbance.lost_share > 0.0)) return;
  std::erase_if(image,
                [&](const ImageSegment&) { return uniform(engine, 0.0, 1.0) < disturbance.lost_share; });
}

}  // namespace vismem
