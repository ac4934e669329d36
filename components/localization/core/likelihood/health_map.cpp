#include "localization/core/likelihood/health_map.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <sstream>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

constexpr int kMaximumHeadings = 720;

using RatePlace = std::function<double(const Pose2&)>;

std::pair<Eigen::Vector2d, Eigen::Vector2d> area(const HealthMapRequest& request, const Eigen::Vector2d& low,
                                                 const Eigen::Vector2d& high) {
  return {request.low.value_or(low), request.high.value_or(high)};
}

/// @return a function that keeps a reference to the map; empty without evidence.
RatePlace chapterRating(const MemoryUpdate& update, const MapIndex& map, HealthParams params,
                        ObservationSource source) {
  params.source = source;
  auto observation = std::make_shared<HealthObservation>(map, params);
  observation->set(update);
  if (observation->isEmpty()) return {};
  return [observation](const Pose2& pose) { return observation->health(pose); };
}

RatePlace robustRating(const MemoryUpdate& update, const MapIndex& map, const HealthMapParams& params,
                       bool by_likelihood) {
  auto observation = std::make_shared<FloorObservation>(observe(update, map, params.observation));
  if (observation->points.empty()) return {};
  return
      [observation, likelihood = RobustLikelihood(map, params.likelihood), by_likelihood](const Pose2& pose) {
        const Rating rating = likelihood.rate(*observation, {pose});
        return by_likelihood ? rating.log_likelihood : rating.explained;
      };
}

}  // namespace

std::string checkRequest(const HealthMapRequest& request, const SegmentMap& map_edges,
                         const HealthMapLimits& limits) {
  std::ostringstream out;
  const auto [low, high] = area(request, map_edges.low(), map_edges.high());
  const double places = ((high - low) / request.cell_m).array().floor().operator+(1.0).prod();
  if (!low.allFinite() || !high.allFinite() || (high.array() < low.array()).any()) {
    out << "area = (" << low.transpose() << ") .. (" << high.transpose()
        << ") (must be finite, with low <= high)";
  } else if (!std::isfinite(request.cell_m) || request.cell_m <= 0.0) {
    out << "cell_m = " << request.cell_m << " (must be > 0)";
  } else if (!(places <= limits.places)) {
    out << "cell_m = " << request.cell_m << " makes more than " << limits.places << " places of "
        << (high - low).x() << " x " << (high - low).y() << " m";
  } else if (request.theta_rad ? !std::isfinite(*request.theta_rad)
                               : request.headings < 1 || request.headings > kMaximumHeadings) {
    out << "heading: " << request.theta_rad.value_or(request.headings) << " (must be finite, or 1.."
        << kMaximumHeadings << " headings)";
  } else if (!request.theta_rad && places * request.headings > limits.ratings) {
    out << "headings = " << request.headings << " at " << places << " places make more than "
        << limits.ratings << " ratings";
  }
  return out.str();
}

HealthMapper::HealthMapper(const HealthMapParams& params, const SegmentMap& map_edges)
    : params_(params),
      chapter_map_(map_edges, chapterIndex(params.map)),
      robust_map_(map_edges, robustIndex(params.likelihood, params.map)) {}

std::optional<HealthMap> HealthMapper::map(const MemoryUpdate& update, const HealthMapRequest& request,
                                           const std::function<bool()>& cancelled) const {
  RatePlace rate;
  switch (request.rating) {
    case PlaceRating::kImage:
      rate = chapterRating(update, chapter_map_, params_.health, ObservationSource::kImage);
      break;
    case PlaceRating::kMemory:
      rate = chapterRating(update, chapter_map_, params_.health, ObservationSource::kMemory);
      break;
    case PlaceRating::kExplained:
    case PlaceRating::kLikelihood:
      rate = robustRating(update, robust_map_, params_, request.rating == PlaceRating::kLikelihood);
      break;
  }
  if (!rate) return std::nullopt;
  HealthMap result;
  result.stamp_us = update.snapshot->stamp_us;
  const auto [low, high] = area(request, robust_map_.low(), robust_map_.high());
  result.low = low;
  result.cell_m = request.cell_m;
  result.columns = static_cast<int>(std::floor((high.x() - low.x()) / request.cell_m)) + 1;
  result.rows = static_cast<int>(std::floor((high.y() - low.y()) / request.cell_m)) + 1;
  std::vector<double> headings;
  for (int i = 0; i < request.headings && !request.theta_rad; ++i) {
    headings.push_back(wrapAngle(2.0 * std::numbers::pi * i / request.headings));
  }
  if (request.theta_rad) headings.push_back(wrapAngle(*request.theta_rad));
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.columns; ++column) {
      if (cancelled && cancelled()) return std::nullopt;
      const Eigen::Vector2d place = result.place(column, row);
      double best = -std::numeric_limits<double>::infinity();
      double heading = headings.front();
      for (const double theta : headings) {
        const double value = rate({place.x(), place.y(), theta});
        if (value <= best) continue;
        best = value;
        heading = theta;
      }
      result.health.push_back(static_cast<float>(best));
      result.theta_rad.push_back(static_cast<float>(heading));
    }
  }
  if (request.rating == PlaceRating::kLikelihood) {
    const float best = *std::max_element(result.health.begin(), result.health.end());
    for (float& value : result.health) value = std::exp(value - best);
  }
  return result;
}

}  // namespace vismem
