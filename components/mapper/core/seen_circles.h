/// @file Circles from the chords that single images saw of them. Pure. See B6, M8.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "active_visual_memory/core/markings/circle_marking.h"
#include "active_visual_memory/core/primitives/finders.h"
#include "mapper/core/landmarks.h"

namespace vismem {

struct SeenCircleParams {
  /// Of the chords of one image, which proposes a circle: it shows a part, without the errors between images.
  CircleParams proposal{.min_coverage = 0.10, .min_chords = 3};
  CircleMarkingParams chords{.confirmed_share = 0.0};  ///< the images decide
  double kernel_m = 0.02;       ///< Cauchy, of the distance of a seen chord from the circle
  double least_sigma_m = 0.01;  ///< of a seen chord across
  double farthest_m = 8.0;
  int least_sightings = 3;     ///< of a part of the circumference ..
  double min_coverage = 0.33;  ///< .. and the share of such parts that makes a circle
};

/// A sighting on the floor of the world.
struct SeenChord {
  LineLandmark::Seen seen;
  std::uint64_t element = 0;
  Label label;
  Segment2 floor;
  double sigma_m = 0.0;  ///< across, of one pixel
  double line_m = 0.0;   ///< of the landmark that it is a sighting of

  std::array<Eigen::Vector2d, 2> cuts() const;
  bool turnsLeftAbout(const Eigen::Vector2d& centre) const;
  /// Whether the ray from the centre crosses it.
  bool coversFrom(const Eigen::Vector2d& centre, const Eigen::Vector2d& direction) const;
};

/// All labelled sightings of a drive.
std::vector<SeenChord> seenChords(const DriveRecord& record, const MapState& state,
                                  const SeenCircleParams& params);

/// Centre and the radii of the edges whose brighter side lies outside (0) and inside (1).
struct SeenCircle {
  Label label;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  std::array<double, 2> radius_m{};
  std::array<int, 2> count{};       ///< of the chords of each edge
  std::vector<std::size_t> chords;  ///< indices, sorted
  double coverage = 0.0;            ///< share of the circumference that enough chords show

  /// > 0: bright. Where one edge was hardly seen, the other one alone is the circle, of width 0.
  double width_m(double least_share) const;
  double middleRadius(double least_share) const;
};

/// Circles that images of different places agree on, by falling coverage; a chord belongs to one of them.
/// What the memory made of the chords does not matter: it matches each with the next along the arc.
std::vector<SeenCircle> findSeenCircles(const std::vector<SeenChord>& chords, const SeenCircleParams& params);

}  // namespace vismem
