/// @file The file that describes a printed board, for all parts of `calibrate`. Pure.
///
///   {"columns": 9, "rows": 6, "square_mm": 29, "family": "tag36h11", "first_tag": 0, "ruler_mm":
///   [99.4, 99.6]}
///
/// `ruler_mm`: what the two rulers of 100 mm measure on the paper, across and up; absent until somebody
/// measured.
#pragma once

#include <optional>
#include <string>

#include "calibration/core/board.h"

namespace vismem {

struct BoardFile {
  BoardSpec nominal;                        ///< squares as drawn
  std::optional<Eigen::Vector2d> ruler_mm;  ///< as measured

  /// The board as it lies on the table: squares by the rulers.
  BoardSpec measured() const;
};

/// @param file for messages. @throw ConfigError "FILE: KEY = VALUE (RULE)".
BoardFile parseBoardFile(const std::string& text, const std::string& file);
std::string writeBoardFile(const BoardFile& board);

/// @return empty, or the problem of two measured rulers: value and rule.
std::string checkRuler(const Eigen::Vector2d& ruler_mm);

}  // namespace vismem
