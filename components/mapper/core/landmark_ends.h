/// @file Where landmarks end, from what single images showed. Pure. See B6.
#pragma once

#include "mapper/core/landmarks.h"

namespace vismem {

struct LandmarkEndParams {
  double along_px = 1.5;  ///< sigma of an observed end
  double least_sigma_m = 0.01;
  double beyond_sigmas = 3.0;  ///< an edge seen further out than this continues there
  int min_views = 2;           ///< that agree on a closed end, or reach as far, where there are so many
  /// A sighting this near to the image of an upright edge at its near end may be one, or a foot that goes on
  /// into one: where the camera stands in the plane of a box's side, both are one straight line.
  double upright_px = 3.0;
  double upright_rad = 0.1;
  int least_raised_views = 3;      ///< with a seen end, to find the height of an edge by it
  double raised_sigmas = 3.0;      ///< scatter of an end on the floor, beyond which it does not lie there ..
  double raised_gain = 3.0;        ///< .. if another height makes it so much smaller
  double most_height_share = 0.8;  ///< heights tried, of the camera's
};

/// Sets both ends of each landmark: the place on its line on which most views agree, near ones counting more,
/// or only a bound where more views show the edge to go on. No landmark reaches further than single images
/// showed it: what the memory holds beyond was matched along the line, such as the next thing's edge. To be
/// called when the graph is near its solution.
void updateEnds(const DriveRecord& record, const LandmarkEndParams& params, MapState& state);

/// Removes landmarks unless `least_views` of their sightings cannot be of an upright edge. @return how
/// many.
int dropUprights(const DriveRecord& record, const LandmarkEndParams& params, int least_views,
                 MapState& state);

/// Removes landmarks whose ends lie at one place for all images at some height, but not on the floor: an edge
/// along the way of the robot shows its height by its ends alone. @return how many.
int dropRaised(const DriveRecord& record, const LandmarkEndParams& params, MapState& state);

/// An observed end on the line of its landmark.
struct SeenEnd {
  double t_m = 0.0;  ///< from the landmark's reference
  double sigma_m = 0.0;
  bool censored = false;
};

/// Where a sighting ends on its landmark's line.
/// @param sigma_px  of the end along the segment.
/// @return empty if the floor is not seen there.
std::optional<SeenEnd> seenEnd(const DriveRecord& record, const MapState& state, const LineLandmark& landmark,
                               const LineLandmark::Seen& seen, bool at_b, double sigma_px);

struct OverlapParams {
  double across_m = 0.05;
  double angle_rad = 0.08;
  double least_share = 0.7;     ///< of the shorter one that lies beside the longer one
  double least_piece_m = 0.10;  ///< shorter rests are dropped
  int min_sightings = 3;        ///< of the one that cuts
};

/// One stretch of floor has one edge. A landmark along which another one of a different label lies was seen
/// from afar, across what is between its pieces: it is cut there.
/// @return number of cuts.
int cutOverlaps(const DriveRecord& record, const OverlapParams& params, MapState& state);

}  // namespace vismem
