/// @file How well every place of the map fits one observation, as a grid (figures 22-27). Pure. SPEC L10.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "localization/core/map_index.h"
#include "localization/core/params.h"

namespace vismem {

/// By what a place is rated, each 0..1.
enum class PlaceRating {
  kImage,      ///< the chapter's health of the last image (L4)
  kMemory,     ///< the chapter's health of the memory (L5)
  kExplained,  ///< default mode's health: the share of the observation that agrees with the map
  kLikelihood  ///< default mode: (L / L of the best place of the grid); 1 at the best place
};

/// Which places. Heading empty: the best of `headings` evenly spread ones, from 0 on.
struct HealthMapRequest {
  PlaceRating rating = PlaceRating::kExplained;
  std::optional<double> theta_rad;
  int headings = 36;
  double cell_m = 0.1;  ///< between places
  /// Corners of the area [m]; empty: the map's bounding box.
  std::optional<Eigen::Vector2d> low;
  std::optional<Eigen::Vector2d> high;
};

struct HealthMapLimits {
  double places = 1e6;
  double ratings = 1e9;  ///< places times headings
};

/// @return empty if the request makes sense, else what is wrong: field, value and rule.
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
  std::vector<float> theta_rad;  ///< the heading that has it

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  Eigen::Vector2d place(int column, int row) const { return low + cell_m * Eigen::Vector2d(column, row); }
};

/// Rates grids of places by both modes' measures, with one set of parameters. Immutable: *thread-safe*.
class HealthMapper {
 public:
  HealthMapper(const LocalizerParams& params, const SegmentMap& map_edges);

  /// @param update as the Localizer takes it. @param request that checkRequest approves.
  /// @param cancelled asked before every place.
  /// @return empty if the observation says nothing of the kind asked for, or when cancelled.
  std::optional<HealthMap> map(const MemoryUpdate& update, const HealthMapRequest& request,
                               const std::function<bool()>& cancelled = {}) const;

 private:
  LocalizerParams params_;
  MapIndex chapter_map_;
  MapIndex robust_map_;
};

}  // namespace vismem
