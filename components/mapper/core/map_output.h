/// @file A solved drive as a map of segments, and maps in the formats of other programs. Pure: texts and
/// bytes, no files. See B6.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/segment_map/segment_map.h"
#include "mapper/core/landmarks.h"

namespace vismem {

/// A row of the map with what is known of it.
struct MappedRow {
  std::uint64_t id = 0;  ///< of its landmark
  MapSegment row;
  Segment2 map;           ///< as estimated, before rounding [m]
  bool closed_a = false;  ///< the edge was seen to end here
  bool closed_b = false;
  double across_sigma_m = 0.0;  ///< of the middle of the line, relative to its surroundings
  double direction_sigma_rad = 0.0;
  double sigma_a_m = 0.0;  ///< of closed ends along the line
  double sigma_b_m = 0.0;
  int times_seen = 0;  ///< keyframes
  int sessions = 1;
  bool derived = false;   ///< the end of a painted line, from its two edges
  bool is_chord = false;  ///< of a circle

  /// Sets the ends of `row` from `map`, in millimetres.
  void updateWorld();
};

struct MapOutputParams {
  double min_length_m = 0.04;
  double stripe_least_m = 0.025;  ///< widths of painted lines
  double stripe_most_m = 0.12;
  double stripe_angle_rad = 0.10;
  double stripe_skew_m = 0.04;  ///< between the ends of both edges along the line
};

/// The frame of the map: x along the longest edge, origin at the first pose.
/// @return T_map_world of the graph's world.
Pose2 mapFrameOf(const MapState& state);

/// The labelled edges, in millimetres: rows of CSV, SVG and DXF are the same numbers.
std::vector<MappedRow> rowsOf(const MapState& state, const Pose2& T_map_world, const MapOutputParams& params);

/// Adds the end edges of painted lines: two edges of one label and opposite polarity that end side by side,
/// where no further edge of the label does. Both then end at one place along the line.
void addStripeEnds(std::vector<MappedRow>& rows, const MapOutputParams& params);

/// The stripes of a palette as rows with a width: pairs of such edges over at least most of their length.
/// @param stripe_edges Palette::stripes(). Without an entry of an edge's label it stays an edge.
void joinIntoStripes(std::vector<MappedRow>& rows, const std::map<Label, Label>& stripe_edges,
                     const MapOutputParams& params);

SegmentMap segmentMapOf(const std::vector<MappedRow>& rows);

/// A drawing that make_map reads back: one line a row with its label, millimetres as user units, the world's
/// origin in `data-origin`. Rows above the floor are left out.
std::string svgOf(const SegmentMap& map);
/// AutoCAD R12 text: lines in metres, one layer a label.
std::string dxfOf(const SegmentMap& map);

/// An occupancy grid as map_server reads it.
struct GridImage {
  int width = 0;
  int height = 0;
  double resolution_m = 0.05;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< lower left corner [m]
  std::vector<unsigned char> cells;               ///< rows from the top: 0 occupied, 254 free, 205 unknown
};

struct GridParams {
  double resolution_m = 0.05;
  double robot_m = 0.22;  ///< radius of the robot: what it drove over is free
  double range_m = 4.0;   ///< floor seen up to the first obstacle within this is free
  double margin_m = 1.0;
  std::vector<std::string> obstacles{"skirting",
                                     "*_foot"};  ///< labels of feet of walls and things: "*_foot" any ending
};

/// Painted lines are no obstacles.
GridImage gridOf(const SegmentMap& map, const DriveRecord& record, const std::vector<Pose2>& poses,
                 const GridParams& params);
/// The bytes of a PGM file (P5).
std::string pgmOf(const GridImage& grid);
/// @param image  name of the PGM file.
std::string gridYamlOf(const GridImage& grid, const std::string& image);

}  // namespace vismem
