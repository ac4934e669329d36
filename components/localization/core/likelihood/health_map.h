/// @file Health of one observation over a grid of places (figures 22-27). Pure. Implements L10.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/likelihood/chapter_health.h"
#include "localization/core/likelihood/robust_likelihood.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"

namespace vismem {

/// The measure of a place, each 0..1.
enum class PlaceRating {
  kImage,      ///< the chapter's health of the last image (L4)
  kMemory,     ///< the chapter's health of the memory (L5)
  kExplained,  ///< default mode's health: share of the observation that agrees with the map
  kLikelihood  ///< default mode's likelihood divided by that of the best place of the grid
};

/// The grid of places. Without a heading each place has the best of `headings` evenly spaced ones.
struct HealthMapRequest {
  PlaceRating rating = PlaceRating::kExplained;
  std::optional<double> theta_rad;
  int headings = 36;
  double cell_m = 0.1;  ///< spacing of places
  /// Corners of the area [m]; empty: the map's bounding box.
  std::optional<Eigen::Vector2d> low;
  std::optional<Eigen::Vector2d> high;
};

struct HealthMapLimits {
  double places = 1e6;
  double ratings = 1e9;  ///< places times headings
};

/// @return empty if the request is valid, else field, value and rule.
std::string checkRequest(const HealthMapRequest& request, const SegmentMap& map_edges,
                         const HealthMapLimits& limits = {});

/// The place of column i and row j is low + cell_m * (i, j).
struct HealthMap {
  StampUs stamp_us = 0;  ///< of the observation
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  double cell_m = 0.0;
  int columns = 0;
  int rows = 0;
  std::vector<float> health;     ///< 0..1, row by row, from low.y upwards
  std::vector<float> theta_rad;  ///< the heading with this health

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  Eigen::Vector2d place(int column, int row) const { return low + cell_m * Eigen::Vector2d(column, row); }
};

struct HealthMapParams {
  MapParams map;
  HealthParams health;
  ObservationParams observation;
  LikelihoodParams likelihood;
};

/// Rates grids of places by the measures of both modes. Immutable: *thread-safe*.
class HealthMapper {
 public:
  HealthMapper(const HealthMapParams& params, const SegmentMap& map_edges);

  /// @param update as Localizer::update takes it.
  /// @param request accepted by checkRequest.
  /// @param cancelled called before every place.
  /// @return empty if the observation has no evidence for this measure, or when cancelled.
  std::optional<HealthMap> map(const MemoryUpdate& update, const HealthMapRequest& request,
                               const std::function<bool()>& cancelled = {}) const;

 private:
  HealthMapParams params_;
  MapIndex chapter_map_;
  MapIndex robust_map_;
};

}  // namespace vismem
