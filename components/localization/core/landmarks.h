/// @file Pairs of segments that fix a pose by themselves: corners, junctions, doors and parallelograms of the
/// memory matched with the map's. Pure. DESIGN 9 part 6.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "common/geometry/segment.h"
#include "localization/core/map_index.h"
#include "localization/core/random_engine.h"
#include "localization/core/robust_observation.h"

namespace vismem {

struct LabelledSegment {
  Segment2 plan;
  int label = 0;
};

/// Two arms that begin at one point: a corner, a side of a T, or a change of label along one line. In one line
/// of a cache.
struct alignas(64) Junction {
  Eigen::Vector2d vertex = Eigen::Vector2d::Zero();
  double direction_a = 0.0;  ///< of arm a, away from the vertex [rad]
  double turn = 0.0;         ///< from arm a to arm b, in (-pi, pi]; about pi along one line
  double length_a = 0.0;     ///< to the end of its segment [m]
  double length_b = 0.0;
  int label_a = 0;
  int label_b = 0;
};

/// The junctions of two segments, every pair of arms once with a first. @param gap_m ends may miss the vertex
/// by this much.
void appendJunctions(const LabelledSegment& s, const LabelledSegment& t, double gap_m,
                     std::vector<Junction>& out);

/// What kinds of landmark make explorers.
struct LandmarkKinds {
  bool corners = true;  ///< junctions of two directions
  bool doors = true;    ///< a whole segment recognised by its length, and changes of label along one line
  bool parallelograms = true;
};

/// Places at which a landmark of the memory lies on one of the map that looks the same.
/// *Pure* after construction.
class LandmarkExplorers {
 public:
  LandmarkExplorers(const MapIndex& map, const LandmarkKinds& kinds);

  /// The landmarks of one observation, with the places they may be.
  class Proposals {
   public:
    bool isEmpty() const { return count_ == 0; }
    /// Number of places. Each is as good a guess as any other.
    std::size_t count() const { return count_; }
    /// @param engine picks one. Not empty.
    Pose2 pick(RandomEngine& engine) const;

   private:
    friend class LandmarkExplorers;
    struct Anchor {  // a point and a direction of a landmark
      Eigen::Vector2d point;
      double direction;
    };
    struct Seen {
      Anchor robot;
      std::vector<Anchor> world;  // where it may be
    };
    std::vector<Seen> seen_;
    std::size_t count_ = 0;
  };
  /// Of each landmark of the memory a sample of the places, spread over the map, if there are many.
  /// @param explorers so many are wanted: for fewer of them the sample is smaller.
  /// @param engine says with which of them to begin.
  Proposals match(const RobustObservation& observation, int explorers, RandomEngine& engine) const;

 private:
  struct Line {
    Segment2 plan;
    double length = 0.0;
  };
  static std::uint64_t key(int label_a, int label_b, int angle_bin);

  LandmarkKinds kinds_;
  std::unordered_map<std::uint64_t, std::vector<Junction>> junctions_;
  std::vector<Junction> parallelogram_corners_;  // counter-clockwise, sides as arms
  std::vector<std::vector<Line>> by_length_;     // per label, shortest first
};

}  // namespace vismem
