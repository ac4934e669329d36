/// @file A person's edits of a map, replayed after each solve. Pure. See B6.
///
/// One edit a line, `#` begins a comment; ID is that of map.json, lengths in metres:
///
///     delete ID                  join ID ID               straighten ID ID...   (all in the line of the
///     first) relabel ID LABEL           split ID FROM TO         square ID ID          (at right angles)
///     move ID a|b X Y            length ID METRES
///
/// `split` leaves the stretch between FROM and TO from end a free. straighten, square and length are
/// constraints of the solve: what else is known of the edges yields. `move` puts an end at a place of the
/// finished map.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mapper/core/landmarks.h"
#include "mapper/core/map_graph.h"
#include "mapper/core/map_output.h"

namespace vismem {

struct MapEdit {
  enum class Kind { kDelete, kRelabel, kJoin, kSplit, kStraighten, kSquare, kLength, kMove };
  Kind kind = Kind::kDelete;
  std::vector<std::uint64_t> ids;
  Label label;
  double from_m = 0.0;  ///< of kSplit; the length of kLength
  double to_m = 0.0;
  bool at_b = false;  ///< of kMove
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  std::string where;  ///< FILE:LINE
};

/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
std::vector<MapEdit> parseMapEdits(std::string_view text, const std::string& file_name);

/// delete, relabel, join and split, in their order.
/// @return one line for each edit without effect: its edges are not there, or do not fit it.
std::vector<std::string> applyEdits(const std::vector<MapEdit>& edits, MapState& state);

/// straighten, square and length as constraints of the next solve. Edges that are not there or do not fit are
/// left out: applyEdits reported them.
std::vector<LineConstraint> constraintsOf(const std::vector<MapEdit>& edits, const MapState& state);

/// move, on the finished rows.
void applyMoves(const std::vector<MapEdit>& edits, std::vector<MappedRow>& rows);

}  // namespace vismem
