/// @file A map after a further drive: answered changes, places seen for the first time, counts. Pure. See B6.
#pragma once

#include <map>

#include "mapper/core/change_list.h"
#include "mapper/core/map_history.h"

namespace vismem {

struct UpdatedMap {
  MapHistory history;  ///< its rows are the map
  int kept = 0;        ///< rows with the same coordinates as before
  int cut = 0;         ///< rows of which a part went; its rest has other ends
  int gone = 0;        ///< whole rows
  int came = 0;        ///< rows of accepted changes
  int added = 0;       ///< rows where no drive before saw the floor
  int seen_again = 0;  ///< kept and cut rows that the drive saw

  SegmentMap map() const;
};

/// Accepted changes take effect; what is rejected or open leaves the map as it was, and what is rejected is
/// remembered. Rows that no accepted change names keep their coordinates.
/// @param old      the map with its history: countedRows().
/// @param stripes  Palette::stripes(): changes name the edges of painted lines, rows the lines.
/// @param list     decided.
/// @param drive    the history of the drive's own map, in its own frame.
UpdatedMap updateMap(const MapHistory& old, const std::map<Label, Label>& stripes, const ChangeList& list,
                     const MapHistory& drive);

}  // namespace vismem
