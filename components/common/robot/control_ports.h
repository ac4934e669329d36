/// @file What can be done with a simulated world or a log besides sensing: the ports behind the interfaces
/// Simulation and Replay. Pure.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "common/robot/ports.h"

namespace vismem {

/// True pose of the simulated robot; no estimator reads it.
struct TruthSample {
  StampUs stamp_us = 0;
  std::uint64_t seq = 0;
  Pose2 T_world_robot;
  bool in_collision = false;    ///< the base is held by an obstacle
  std::uint32_t kidnaps = 0;    ///< so far
};

struct SimulationStatus {
  std::string world;
  std::uint64_t seed = 0;
  StampUs stamp_us = 0;
  bool paused = false;
  double speed = 1.0;       ///< asked for: simulated seconds per second
  double real_speed = 0.0;  ///< reached, over the last second
};

class SimulationControl {
 public:
  virtual ~SimulationControl() = default;
  virtual SimulationStatus status() const = 0;
  virtual SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds timeout) = 0;
  /// Puts the robot elsewhere without telling its odometry. Rejected for places inside an obstacle.
  virtual PortReply kidnap(const Pose2& T_world_robot) = 0;
  virtual PortReply pause() = 0;
  virtual PortReply resume() = 0;
  /// @param speed 0.01..1000.
  virtual PortReply setSpeed(double speed) = 0;
};

enum class ReplayState { kWaiting, kPlaying, kPaused, kFinished };

struct ReplayStatus {
  ReplayState state = ReplayState::kWaiting;
  std::string file;
  StampUs first_us = 0;  ///< of the log's first and last image
  StampUs last_us = 0;
  StampUs stamp_us = 0;  ///< now
  double rate = 1.0;     ///< log seconds per second
  bool loop = false;
};

class ReplayControl {
 public:
  virtual ~ReplayControl() = default;
  virtual ReplayStatus status() const = 0;
  virtual PortReply play() = 0;
  virtual PortReply pause() = 0;
  /// Clamped to the log ("adjusted").
  virtual PortReply seek(StampUs stamp_us) = 0;
  /// @param rate 0.01..1000.
  virtual PortReply setRate(double rate) = 0;
  virtual PortReply setLoop(bool loop) = 0;
};

}  // namespace vismem
