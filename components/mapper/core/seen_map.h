/// @file A map with what the drives that made it looked at: how often a place was seen, unhidden. Pure. See
/// B6.
#pragma once

#include <vector>

#include "localization/core/map/visibility.h"
#include "mapper/core/map_changes.h"

namespace vismem {

struct SeenEdge {
  Segment2 floor;
  Label label;
  bool is_counted = false;  ///< by drives; a drawing states no number
  int times_seen = 0;
};

/// *Pure* after construction. Lives no longer than sessions and parameters.
class SeenMap {
 public:
  SeenMap(const std::vector<CountedRow>& map, const std::vector<SeenFloor>& sessions,
          const ChangeParams& params);

  /// Those on the floor.
  const std::vector<SeenEdge>& edges() const { return edges_; }

  /// How often a place was looked at, unhidden by this map's edges, and an edge was seen there.
  struct Looks {
    double views = 0.0;
    double sightings = 0.0;
  };
  Looks looksAt(const Eigen::Vector2d& p, const SeenEdge& edge) const;
  /// Views of a place of this map's own edge, by the drives that saw it: it may have come after the others.
  double viewsOfOwn(const Eigen::Vector2d& p, const SeenEdge& edge) const;
  /// Whether an edge of this map with its label lies here.
  bool liesOn(const Eigen::Vector2d& p, const SeenEdge& edge) const;

 private:
  struct View {
    Eigen::Vector2d camera;  ///< below it [m]
    CameraView view;
  };
  struct Session {
    std::vector<View> views;
    const std::vector<FloorTrace>* traces = nullptr;
  };

  bool isNear(const Eigen::Vector2d& p, const Segment2& edge, const Segment2& own) const;
  bool isHidden(const Eigen::Vector2d& camera, const Eigen::Vector2d& p) const;
  Looks looksOf(const Session& session, const Eigen::Vector2d& p, const SeenEdge& edge) const;

  std::vector<SeenEdge> edges_;
  std::vector<Segment2> walls_;
  std::vector<Session> sessions_;
  const ChangeParams& params_;
};

}  // namespace vismem
