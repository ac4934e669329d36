/// @file Control of a simulated world or a log: the ports behind the interfaces Simulation and Replay. Pure.
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
  bool in_collision = false;  ///< an obstacle stops the base
  std::uint32_t kidnaps = 0;  ///< number since time 0
};

struct SimulationStatus {
  std::string world;
  std::uint64_t seed = 0;
  StampUs stamp_us = 0;
  bool paused = false;
  double speed = 1.0;       ///< commanded: simulated seconds per second
  double real_speed = 0.0;  ///< reached, over the last second
  int lock_step = 0;        ///< number of image consumers that simulated time waits for; 0: real time
};

/// A simple object for a world; its origin lies at its bottom.
struct PropShape {
  /// kRobot: another robot, round below with a pillar above.
  enum class Kind { kBox, kCylinder, kRobot };
  Kind kind = Kind::kBox;
  Eigen::Vector3d size_m{0.4, 0.4, 0.4};  ///< along x, y, z; x is the diameter of round objects
  Eigen::Vector3d color{0.7, 0.2, 0.2};   ///< R G B, 0..1
};

struct ModelStatus {
  std::string name;
  Pose3 T_world_model = Pose3::Identity();
  bool present = true;  ///< false: removed
  bool walking = false;
};

/// Behaviour of a walker at the last way-point of an open path. A closed path is a loop.
enum class WayEnd { kBack, kStand };

/// The path of a moving model.
struct Way {
  std::vector<Eigen::Vector2d> points;  ///< in world [m], 2 or more
  bool closed = false;
  WayEnd at_end = WayEnd::kBack;
  double speed_mps = 0.4;
};

/// The world and its clock. Every call returns after its execution.
class SimulationControl {
 public:
  virtual ~SimulationControl() = default;
  virtual SimulationStatus status() const = 0;
  virtual SampleBatch<TruthSample> truthSince(StampUs after_us, std::chrono::milliseconds timeout) = 0;
  /// Moves the robot to another pose; odometry does not report it. Rejected for places inside an obstacle.
  virtual PortReply kidnap(const Pose2& T_world_robot) = 0;
  virtual PortReply pause() = 0;
  virtual PortReply resume() = 0;
  /// @param speed 0.01..1000.
  virtual PortReply setSpeed(double speed) = 0;

  /// Advances a paused simulation by steps of 10 ms.
  /// @param steps 1..1000.
  virtual PortReply step(int steps) = 0;
  /// Lock-step: simulated time stops until `consumers` clients wait for a newer image.
  /// @param consumers 0..64; 0: real time.
  virtual PortReply setLockStep(int consumers) = 0;
  /// Restarts world and scenario at time 0 with another seed.
  virtual PortReply reset(std::uint64_t seed) = 0;

  virtual std::vector<ModelStatus> models() = 0;
  /// Rejected for a name in use or an invalid shape.
  virtual PortReply addModel(const std::string& name, const PropShape& shape, const Pose3& T_world_model) = 0;
  virtual PortReply removeModel(const std::string& name) = 0;
  /// Moves a model, also a removed one, which is then present again. A walking model stops.
  virtual PortReply placeModel(const std::string& name, const Pose3& T_world_model) = 0;
  /// A moving occluder: walks its path from the nearest point on, and waits while the robot blocks it.
  virtual PortReply walkModel(const std::string& name, const Way& way) = 0;
  virtual PortReply standModel(const std::string& name) = 0;
  /// Wheel slip: travel of each wheel beyond that of the robot [m].
  virtual PortReply slip(double left_m, double right_m) = 0;
  /// Plays a scenario (format: docs/scenarios.md) from now on in place of the present one; empty text: none.
  virtual PortReply playScenario(const std::string& text) = 0;
};

enum class ReplayState { kWaiting, kPlaying, kPaused, kFinished };

/// One topic of a log.
struct LogTopicInfo {
  std::string name;
  std::string type;  ///< "sensor_msgs/Image"
  std::uint64_t messages = 0;
};

/// What a log holds, and what of it is played.
struct ReplayContents {
  std::vector<LogTopicInfo> topics;  ///< sorted by name
  std::vector<std::string> notes;    ///< what was damaged or left out, for people
  std::uint64_t images = 0;          ///< that are played
  StampUs begin_us = 0;              ///< of the range that is played
  StampUs end_us = 0;
};

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
  /// Pauses and shows the image that lies so many images further on, or back. @param images -100000..100000.
  virtual PortReply step(int images) = 0;
  /// Later plays go on for so long and then pause. @param length_us 0: to the end.
  virtual PortReply setPlayLength(StampUs length_us) = 0;
  /// Plays, loops and seeks stay between two stamps, clamped to the log ("adjusted"). @param begin_us <
  /// end_us.
  virtual PortReply setRange(StampUs begin_us, StampUs end_us) = 0;
  virtual ReplayContents contents() const = 0;
};

}  // namespace vismem
