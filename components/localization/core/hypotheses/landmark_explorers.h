/// @file Landmark explorers: pairs of segments that fix a pose (corners, junctions, doors, parallelograms),
/// matched between observation and map. Pure. See L6.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/geometry/segment.h"
#include "localization/core/map/map_index.h"
#include "localization/core/observation/floor_observation.h"
#include "localization/core/random_engine.h"

namespace vismem {

struct LandmarkSegment {
  Segment2 plan;
  int label = 0;
};

/// Two arms from one vertex: a corner, one side of a T, or a change of label along one line. Sized to one
/// cache line.
struct alignas(64) JunctionLandmark {
  Eigen::Vector2d vertex = Eigen::Vector2d::Zero();
  double direction_a = 0.0;  ///< of arm a, away from the vertex [rad]
  double turn = 0.0;         ///< from arm a to arm b, in (-pi, pi]; about pi along one line
  double length_a = 0.0;     ///< to the end of its segment [m]
  double length_b = 0.0;
  int label_a = 0;
  int label_b = 0;
};

/// Appends the junctions of two segments, each pair of arms once, with arm a of the first segment.
/// @param gap_m largest distance of the ends from the vertex.
void appendJunctions(const LandmarkSegment& s, const LandmarkSegment& t, double gap_m,
                     std::vector<JunctionLandmark>& out);

/// Kinds of landmark in use.
struct LandmarkKinds {
  bool corners = true;  ///< junctions of two directions
  bool doors = true;    ///< whole segments recognised by length, and changes of label along one line
  bool parallelograms = true;
};

/// Poses at which an observed landmark coincides with a similar one of the map. *Pure* after construction.
class LandmarkExplorers {
 public:
  LandmarkExplorers(const MapIndex& map, const LandmarkKinds& kinds);

  /// The landmarks of one observation with their possible poses.
  class Proposals {
   public:
    bool isEmpty() const { return count_ == 0; }
    /// Number of pairs of an observed and a map landmark.
    std::size_t count() const { return count_; }
    /// Draws an observed landmark, then one of its map landmarks. Must not be empty.
    Pose2 pick(RandomEngine& engine) const;

   private:
    friend class LandmarkExplorers;
    struct Anchor {  // a point and a direction of a landmark
      Eigen::Vector2d point;
      double direction;
    };
    struct Seen {
      Anchor robot;
      std::vector<Anchor> world;  // similar landmarks of the map
    };
    void add(Seen seen);

    std::vector<Seen> seen_;
    std::size_t count_ = 0;
  };
  /// Pairs each observed landmark with similar ones of the map; with an evenly spaced sample if there are
  /// many.
  /// @param explorers number of explorers; the size of the sample grows with it.
  /// @param engine draws the first element of each sample.
  Proposals match(const FloorObservation& observation, int explorers, RandomEngine& engine) const;

 private:
  struct Line {
    Segment2 plan;
    double length = 0.0;
  };
  class Sampler;
  static std::uint64_t key(int label_a, int label_b, int angle_bin);
  void indexParallelograms(std::span<const JunctionLandmark> junctions);
  void matchJunctions(std::span<const JunctionLandmark> seen, Sampler& sampler, Proposals& proposals) const;
  void matchLengths(std::span<const ObservedSegment> segments, Sampler& sampler, Proposals& proposals) const;
  void matchParallelogram(const std::array<Eigen::Vector2d, 4>& corners, Sampler& sampler,
                          Proposals& proposals) const;

  LandmarkKinds kinds_;
  std::unordered_map<std::uint64_t, std::vector<JunctionLandmark>> junctions_;
  std::vector<JunctionLandmark> parallelogram_corners_;  // counter-clockwise, sides as arms
  std::vector<std::vector<Line>> by_length_;             // per label, shortest first
};

}  // namespace vismem
