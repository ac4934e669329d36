/// @file `calibrate body` on the simulator's rendered images: a drawn robot beside a board on the floor,
/// driven and recorded through its ports as a real one.
#pragma once

#include "calibration/app/body_recorder.h"
#include "calibration/simulated_board_robot.h"

namespace vismem {

/// Squares of 90 mm, 6 x 4: about A2. Its tags can be read from 1 m, 0.45 m above the floor, at 640x480.
BoardSpec a2Board();

/// A drawn robot as the simulator can be one: no rolling shutter, no skew of the axes.
TrueRobot drawnForSimulator(std::uint64_t seed);
/// A drive that keeps the tags readable.
BodyDriveParams driveInSimulator();

struct SimulatedBodyTrial {
  BodyRecord record;
  BodyDrive drive;
  double farthest_m = 0.0;  ///< of the robot from the board's middle
  double seconds = 0.0;     ///< of the robot's time
};

/// Runs the drive on a simulated robot that is the drawn one.
SimulatedBodyTrial runInSimulator(const TrueRobot& truth, std::uint64_t seed, const BodyDriveParams& params);

}  // namespace vismem
