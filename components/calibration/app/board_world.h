/// @file The calibration board on a floor as a world of the simulator.
#pragma once

#include <filesystem>

#include "calibration/core/board.h"

namespace vismem {

/// Writes FOLDER/board.world with the model `board`, and its picture FOLDER/board.png. The middle of the
/// chessboard is the world's origin, its x and y the world's, its print the floor's height.
/// @return the world's file. @throw std::runtime_error naming the file.
std::filesystem::path writeBoardWorld(const BoardSpec& board, const std::filesystem::path& folder);

}  // namespace vismem
