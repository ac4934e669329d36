/// @file What is known of a map beside its rows: the mapping sessions that saw it, how often each row was
/// seen, and which changes were rejected. Pure. One line a value, fields between blanks, `#` begins a
/// comment:
///
///     history 1
///     complete 0|1                       (1: the map came from elsewhere and shows all of the place)
///     row LABEL WIDTH TIMES_SEEN SESSIONS X1 Y1 X2 Y2
///     gone LABEL X1 Y1 X2 Y2 ...         (rejected: the map keeps these edges, though a drive missed them)
///     came LABEL X1 Y1 X2 Y2 ...         (rejected: the map does not take these edges)
///     session
///     camera WIDTH HEIGHT FX FY CX CY
///     view R11 R12 R13 X R21 ... Z       (T_map_camera by rows)
///     trace LABEL SIGHTINGS X1 Y1 X2 Y2
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mapper/core/keyframe.h"
#include "mapper/core/map_changes.h"
#include "mapper/core/record_text.h"

namespace vismem {

/// A line of a history or a list of changes.
void writeFact(LineWriter& out, const ChangeFact& fact);
ChangeFact readFact(bool is_gone, LineFields& in);

struct MapHistory {
  SeenBefore seen{{}, false};
  std::vector<CountedRow> rows;
  std::vector<ChangeFact> rejected;
};

/// Numbers are written so that they are read back exactly.
std::string writeMapHistory(const MapHistory& history);
/// @throws ConfigError with FILE:LINE, what was found and what was expected.
MapHistory parseMapHistory(std::string_view text, const std::string& file_name);

/// The rows of a map with the counts of its history; a row that was edited since has none.
std::vector<CountedRow> countedRows(const SegmentMap& map, const MapHistory& history);

/// Painted lines as their edges, as segment_map's.
std::vector<CountedRow> expandStripes(const std::vector<CountedRow>& rows,
                                      const std::map<Label, Label>& stripe_edges);

/// What a drive looked at, and what its memory held, in the frame of the poses of its keyframes.
/// @param overruled elements of the memory that are left out (see MapState).
SeenFloor seenBy(const DriveRecord& record, const std::vector<Pose2>& poses,
                 const std::set<std::uint64_t>& overruled = {});

/// All in another frame.
MapHistory transform(const Pose2& T_a_b, MapHistory history_b);
SegmentMap transform(const Pose2& T_a_b, SegmentMap map_b);

}  // namespace vismem
