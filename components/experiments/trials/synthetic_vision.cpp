#include "experiments/trials/synthetic_vision.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/projection.h"
#include "experiments/trials/gaussian.h"

namespace vismem {
namespace {

/// An older state is not correlated with the present one.
constexpr double kForgotten_s = 1.0;
constexpr double kImage_s = 0.1;  // the time over which `persistence` is given
constexpr double kShortestFalse_px = 12.0;
/// Edges of average contrast.
constexpr double kStrength = 40.0;

/// Of a standard normal, the share of values below this one.
double shareBelow(double normal) {
  return 0.5 * std::erfc(-normal / std::numbers::sqrt2);
}

}  // namespace

SyntheticVision::SyntheticVision(const SegmentMap& edges, const VisionErrors& errors,
                                 const Disturbance& disturbance, std::uint64_t seed, std::uint64_t map_seed)
    : edges_(edges),
      errors_(errors),
      disturbance_(disturbance),
      engine_(seed),
      floor_labels_(edgeLabels(edges, true)),
      upright_labels_(edgeLabels(edges, false)),
      clutter_(disturbance, edges) {
  RandomEngine map_engine(map_seed);
  map_errors_.resize(edges_.segments.size());
  for (MapError& error : map_errors_) {
    for (double* value : {&error.across, &error.along_a, &error.along_b}) {
      *value = standardNormal(map_engine);
    }
  }
}

const Label& SyntheticVision::anyLabel(bool on_floor) {
  const std::vector<Label>& labels = on_floor || upright_labels_.empty() ? floor_labels_ : upright_labels_;
  return labels.empty() ? kUnknownLabel : labels[pick(engine_, labels.size())];
}

std::vector<ImageSegment> SyntheticVision::observe(double time_s, const CameraIntrinsics& intrinsics,
                                                   const Pose3& T_world_camera, const CastRay& cast) {
  std::vector<ImageSegment> image;
  for (const VisiblePiece& piece : visiblePieces(edges_, intrinsics, T_world_camera, cast)) {
    addPiece(time_s, intrinsics, piece, image);
  }
  for (const VisiblePiece& outline : visibleOutlines(edges_, intrinsics, T_world_camera, cast)) {
    addPiece(time_s, intrinsics, outline, image);
  }
  double expected = errors_.false_per_image;
  for (; uniform(engine_, 0.0, 1.0) < expected; expected -= 1.0) addFalse(intrinsics, image);
  clutter_.add(time_s, intrinsics, T_world_camera, engine_, image);
  loseSegments(disturbance_, engine_, image);
  return image;
}

void SyntheticVision::age(double time_s, bool on_floor, EdgeState& state) {
  const double past_s = time_s - state.time_s;
  state.time_s = time_s;
  const auto goOn = [this](double& value, double kept) {
    value = kept * value + std::sqrt(1.0 - kept * kept) * standardNormal(engine_);
  };
  goOn(state.luck, past_s > kForgotten_s ? 0.0 : std::pow(errors_.persistence, past_s / kImage_s));
  const double across_s = on_floor ? errors_.across_floor.same.lasts_s : errors_.upright_lasts_s;
  const double along_s = on_floor ? errors_.along_floor.same.lasts_s : errors_.upright_lasts_s;
  for (EndState* end : {&state.a, &state.b}) {
    goOn(end->across, std::exp(-past_s / across_s));
    goOn(end->along, std::exp(-past_s / along_s));
    goOn(end->hidden, std::exp(-past_s / errors_.hidden_end_same.lasts_s));
  }
}

double SyntheticVision::fresh(const VisionErrors::Lasting& same, double always, double lasting) {
  return std::sqrt(same.always) * always + std::sqrt(same.lasting) * lasting +
         std::sqrt(1.0 - same.always - same.lasting) * standardNormal(engine_);
}

Eigen::Vector2d SyntheticVision::endError(const CameraIntrinsics& intrinsics, const VisiblePiece& piece,
                                          bool first, bool on_floor, const EndState& state) {
  // All numbers are drawn in any case, so that the later ones do not depend on the case.
  const MapError& map = map_errors_[static_cast<std::size_t>(piece.edge)];
  const std::size_t range = VisionStatistics::rangeBin(piece.range_m);
  const auto& by_range = errors_.along_floor;
  const double across = fresh(errors_.across_floor.same, map.across, state.across);
  const double along = fresh(by_range.same, first ? map.along_a : map.along_b, state.along);
  const double hidden = fresh(errors_.hidden_end_same, 0.0, state.hidden);
  const double outline_end = standardNormal(engine_);
  const double outline_side = standardNormal(engine_);
  const bool is_hidden = first ? piece.hidden_a : piece.hidden_b;
  const auto upright = [this](const VisionErrors::Spread& spread, double lasting) {
    return spread.lasting_px * lasting + spread.fresh_px * standardNormal(engine_);
  };
  Eigen::Vector2d error(upright(errors_.across_upright, state.across),
                        errors_.along_upright_mean_px + upright(errors_.along_upright, state.along));
  if (on_floor) {
    error.x() = errors_.across_floor.px[range].at(shareBelow(across));
    error.y() =
        is_hidden ? errors_.hidden_end.at(shareBelow(hidden)) : by_range.px[range].at(shareBelow(along));
  }
  if (piece.is_outline) {
    error.x() = errors_.outline_across.at(shareBelow(outline_side));
    error.y() = (is_hidden ? errors_.outline_top : errors_.outline_foot).at(shareBelow(outline_end));
  }
  if (isAtBorder(intrinsics, first ? piece.px.a : piece.px.b)) error.y() = -errors_.border_px;
  return error;
}

void SyntheticVision::addPiece(double time_s, const CameraIntrinsics& intrinsics, const VisiblePiece& piece,
                               std::vector<ImageSegment>& image) {
  const MapSegment& edge = edges_.segments[static_cast<std::size_t>(piece.edge)];
  const bool on_floor = isOnFloor(edge) && !piece.is_outline;
  EdgeState& state = (piece.is_outline ? outline_states_ : states_)[piece.edge];
  age(time_s, on_floor, state);
  const double length = piece.px.length();
  const double most = piece.is_outline ? errors_.outlines_found : errors_.found;
  const double p_found = most / (1.0 + std::exp((errors_.half_px - length) / errors_.soft_px));
  const Eigen::Vector2d error_a = endError(intrinsics, piece, true, on_floor, state.a);
  const Eigen::Vector2d error_b = endError(intrinsics, piece, false, on_floor, state.b);
  const bool is_unknown = uniform(engine_, 0.0, 1.0) < errors_.unknown;
  if (shareBelow(state.luck) > p_found) return;

  const Eigen::Vector2d along = (piece.px.b - piece.px.a) / length;
  const Eigen::Vector2d across(along.y(), -along.x());
  const Segment2 found{piece.px.a - error_a.y() * along + error_a.x() * across,
                       piece.px.b + error_b.y() * along + error_b.x() * across};
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
  const Eigen::Vector2d a = anyPixel(intrinsics, engine_);
  const double direction = uniform(engine_, -std::numbers::pi, std::numbers::pi);
  const double length = uniform(engine_, kShortestFalse_px, errors_.longest_false_px);
  const Label& label = anyLabel(uniform(engine_, 0.0, 1.0) < errors_.false_on_floor);
  const auto inside =
      clipToBox({a, a + length * Eigen::Vector2d(std::cos(direction), std::sin(direction))},
                Eigen::Vector2d::Zero(), Eigen::Vector2d(intrinsics.width - 1.0, intrinsics.height - 1.0));
  if (inside && inside->length() >= errors_.least_px) image.push_back({*inside, label, kStrength});
}

}  // namespace vismem
