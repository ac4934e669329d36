/// @file `calibrate body` on the simulator's rendered images: a drawn robot beside a board on the floor,
/// driven and recorded through its ports as a real one.
#pragma once

#include <functional>

#include "calibration/app/body_recorder.h"
#include "calibration/simulated_board_robot.h"

namespace vismem {

/// Squares of 90 mm, 6 x 4: about A2. Its tags can be read from 1 m, 0.45 m above the floor, at 640x480.
BoardSpec a2Board();

/// A drawn robot as the simulator can be one: no rolling shutter, no skew of the axes.
TrueRobot drawnForSimulator(std::uint64_t seed);
/// A drive that keeps the tags readable.
BodyDriveParams driveInSimulator();

/// Refused: not followed, as when an answer was late. Throws: the program that commands has a failure.
enum class HeadFault { kNone, kRefused, kThrows };

struct SimulatedBodyTrial {
  BodyRecord record;
  BodyDrive drive;
  double farthest_m = 0.0;  ///< of the robot from the board's middle
  double seconds = 0.0;     ///< of the robot's time
};

/// Runs the drive on a simulated robot that is the drawn one.
/// @param fault what becomes of a command of the head, by its number; empty: all are followed.
SimulatedBodyTrial runInSimulator(const TrueRobot& truth, std::uint64_t seed, const BodyDriveParams& params,
                                  const std::function<HeadFault(int)>& fault = {});

}  // namespace vismem
