/// @file The map of a synthetic drive against its truth.
#pragma once

#include <vector>

#include "evaluation/core/map_score.h"
#include "mapper/core/landmarks.h"
#include "synthetic_drive.h"

namespace vismem {

/// Rigid alignment of the robot's places with the true ones.
inline Pose2 placesOnTruth(const MapState& state, const SyntheticDrive& drive) {
  std::vector<Eigen::Vector2d> places;
  std::vector<Eigen::Vector2d> truth;
  for (std::size_t k = 0; k < drive.truth.size(); ++k) {
    places.push_back(state.poses[k].position());
    truth.push_back(drive.truth[k].position());
  }
  return rigidFit(places, truth);
}

/// Every edge counts as seen, from 1 m: the synthetic camera has no walls.
inline MapScore scoreOf(const MapState& state, const std::vector<TrueFloorEdge>& edges,
                        const SyntheticDrive& drive) {
  SegmentMap floor;
  for (const TrueFloorEdge& edge : edges) {
    const Segment2& s = edge.world;
    floor.segments.push_back({{{s.a.x(), s.a.y(), 0.0}, {s.b.x(), s.b.y(), 0.0}}, edge.label});
  }
  std::vector<TrueEdge> truth = FloorTruth(floor).edges();
  for (TrueEdge& edge : truth) {
    for (TrueEdge::Sample& sample : edge.samples) {
      sample.seen = true;
      sample.nearest_m = 1.0;
      sample.camera_height_m = 0.45;
    }
  }
  std::vector<MappedEdge> map;
  for (const LineLandmark& landmark : state.landmarks) {
    map.push_back({state.worldSegment(landmark), landmark.label, landmark.a.closed, landmark.b.closed});
  }
  return scoreMap(map, truth, placesOnTruth(state, drive));
}

}  // namespace vismem
