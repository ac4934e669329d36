/// @file A list of changes that a person answers: NAME.changes. Pure. One line a value, `#` begins a comment:
///
///     changes 1
///     map CHECKSUM                       (of the earlier one: it takes the list once)
///     frame X Y THETA                    (of the drive's map in the earlier one)
///     change NUMBER open|accept|reject moved|removed|new LABEL
///     was X1 Y1 X2 Y2                    (an edge of the change before it)
///     now X1 Y1 X2 Y2
///     added LABEL X1 Y1 X2 Y2            (where no drive before saw the floor)
///     gone LABEL X1 Y1 X2 Y2 ...         (rejected before, and still so)
///     came LABEL X1 Y1 X2 Y2 ...
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapper/core/map_history.h"

namespace vismem {

enum class Decision { kOpen, kAccept, kReject };

struct ListedChange {
  MapChange change;
  Decision decision = Decision::kOpen;
};

/// All in the frame of the earlier map. A change's number is its place, from 1.
struct ChangeList {
  Pose2 T_old_map;  ///< of the drive's own map
  std::vector<ListedChange> changes;
  std::vector<MapSegment> added;
  std::vector<ChangeFact> rejected;  ///< before, and nothing speaks against them
  /// checksumOf the earlier map; empty: nobody knows.
  std::optional<std::int64_t> map{};
};

/// Of all rows.
std::int64_t checksumOf(const SegmentMap& map);

/// "moved box_foot from 1.20 -0.40 to 1.55 -0.30".
std::string lineOf(const MapChange& change);

/// All changes open.
ChangeList changeListOf(const MapComparison& found, const Pose2& T_old_map, const SegmentMap& old);

std::string writeChangeList(const ChangeList& list);
/// @throws ConfigError with FILE:LINE, what was found and what was expected.
ChangeList parseChangeList(std::string_view text, const std::string& file_name);

/// Decides what a command line says. Numbers have precedence over `all`, which means what is open.
/// @param accept, reject  "1,3", "all" or empty.
/// @throws ConfigError naming the option, what was found and what was expected.
void decide(ChangeList& list, const std::string& accept, const std::string& reject);

}  // namespace vismem
