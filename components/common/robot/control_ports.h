/// @file What can be done with a simulated world or a log besides sensing: the ports behind the interfaces
/// Simulation and Replay. Pure.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/robot/ports.h"

namespace vismem {

/// True pose of the simulated robot; no estimator reads it.
struct TruthSample {
  StampUs stamp_us = 0;
  std::uint64_t seq = 0;
  Pose2 T_world_robot;
  bool in_collision = false;  ///< the base is held by an obstacle
  std::uint32_t kidnaps = 0;  ///< so far
};

struct SimulationStatus {
  std::string world;
  std::uint64_t seed = 0;
  StampUs stamp_us = 0;
  bool paused = false;
  double speed = 1.0;       ///< asked for: simulated seconds per second
  double real_speed = 0.0;  ///< reached, over the last second
  int lock_step = 0;        ///< consumers of images that time waits for; 0: time goes by the clock
};

/// A simple thing to put into a world; it stands on its origin.
struct PropShape {
  /// kRobot: another robot, round below with a pillar above.
  enum class Kind { kBox, kCylinder, kRobot };
  Kind kind = Kind::kBox;
  Eigen::Vector3d size_m{0.4, 0.4, 0.4};  ///< along x, y, z; of round things, x is the diameter
  Eigen::Vector3d color{0.7, 0.2, 0.2};   ///< R G B, 0..1
};

struct ModelStatus {
  std::string name;
  Pose3 T_world_model = Pose3::Identity();
  bool present = true;  ///< false: removed
  bool walking = false;
};

/// What a walker does at the last way-point of an open way; a closed one is walked round and round.
enum class WayEnd { kBack, kStand };

/// A way for a model to walk.
struct Way {
  std::vector<Eigen::Vector2d> points;  ///< in world [m], 2 or more
  bool closed = false;
  WayEnd at_end = WayEnd::kBack;
  double speed_mps = 0.4;
};

/// The world and its clock. Every call returns when what it asks for is done.
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

  /// While paused: so many steps of 10 ms. @param steps 1..1000.
  virtual PortReply step(int steps) = 0;
  /// Time waits for so many consumers to ask for an image newer than the last; 0: it goes by the clock.
  /// 0..64.
  virtual PortReply setLockStep(int consumers) = 0;
  /// Everything from the beginning, at time 0, with another seed; the scenario too.
  virtual PortReply reset(std::uint64_t seed) = 0;

  virtual std::vector<ModelStatus> models() = 0;
  /// Rejected for a name in use or a shape that makes no sense.
  virtual PortReply addModel(const std::string& name, const PropShape& shape, const Pose3& T_world_model) = 0;
  virtual PortReply removeModel(const std::string& name) = 0;
  /// Also brings a removed model back. A walking one stands from then on.
  virtual PortReply placeModel(const std::string& name, const Pose3& T_world_model) = 0;
  /// A moving occluder: walks from the nearest place of its way on, and waits where the robot stands in it.
  virtual PortReply walkModel(const std::string& name, const Way& way) = 0;
  virtual PortReply standModel(const std::string& name) = 0;
  /// The wheels turn this much further than the robot goes [m].
  virtual PortReply slip(double left_m, double right_m) = 0;
  /// Plays a scenario (its text: docs/scenarios.md) from now on instead of the one before; empty text: none.
  virtual PortReply playScenario(const std::string& text) = 0;
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
