/// @file The record of a drive as text: a map can be solved again, with edits, without the recording. Pure.
///
/// One line a value, fields between blanks, `#` begins a comment:
///
///     drive 1
///     camera WIDTH HEIGHT FX FY CX CY
///     element ID LABEL CONFIRMED DROPPED FIRST LAST SIGHTINGS AX AY BX BY CENSORED_A CENSORED_B
///     keyframe STAMP_US X Y THETA TURN_RATE WAY TURNED R11 R12 R13 X R21 ... Z   (T_robot_camera by rows)
///     sighting ELEMENT AX AY BX BY CENSORED_A CENSORED_B                        (of the keyframe before it)
///     closing FROM TO X Y THETA P11 P12 P13 P22 P23 P33
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mapper/core/keyframe.h"
#include "mapper/core/pose_graph.h"

namespace vismem {

struct SavedDrive {
  DriveRecord record;
  std::vector<Closing> closings;  ///< accepted ones
};

/// Numbers are written so that they are read back exactly.
std::string writeDriveRecord(const SavedDrive& drive);

/// @throws ConfigError with FILE:LINE, what was found and what was expected.
SavedDrive parseDriveRecord(std::string_view text, const std::string& file_name);

}  // namespace vismem
