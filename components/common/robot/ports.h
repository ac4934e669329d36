/// @file The three ports of a robot. Drivers, the simulator, the replay of a log and the Ice clients of
/// remote servers implement them; all other code uses only these ports. See C2.
///
/// Life of a port: capabilities() at any time; configure() before start(); next()/samples/commands between
/// start() and stop(). Failures at run time are returned, never thrown: a source that is gone may come back.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/samples.h"

namespace vismem {

/// Answer of a source to a request: accepted, adjusted (`message` has the new values), or rejected (`message`
/// has the reason).
struct PortReply {
  enum class Kind { kAccepted, kAdjusted, kRejected };
  Kind kind = Kind::kAccepted;
  std::string message;

  bool ok() const { return kind != Kind::kRejected; }
  static PortReply accepted() { return {}; }
  static PortReply adjusted(std::string what) { return {Kind::kAdjusted, std::move(what)}; }
  static PortReply rejected(std::string why) { return {Kind::kRejected, std::move(why)}; }
};

enum class SourceState {
  kRunning,   ///< delivers
  kWaiting,   ///< no data yet, or the peer or device is away; `message` has the reason; ask again
  kFinished,  ///< the log has ended: no data until it is rewound
};

/// --- camera ---------------------------------------------------------------------------------------

struct FrameRequest {
  int width = 0;         ///< 0: the source's own choice
  int height = 0;        ///< 0: the source's own choice
  double rate_hz = 0.0;  ///< 0: the source's own choice
  /// The consumer accepts Frame::native in place of pixels, for example a server that forwards JPEG.
  bool accept_native = false;
};

/// Largest accepted side of an image [px] and accepted range of rates [Hz].
constexpr int kMaxImageSide_px = 16384;
constexpr double kMinFrameRate_hz = 0.001;
constexpr double kMaxFrameRate_hz = 10'000.0;

/// @return a rejection with value and rule for a request that no source accepts: negative or huge sizes,
/// rates that are negative, not finite or out of range. Every implementation calls this first.
std::optional<PortReply> rejectAbsurd(const FrameRequest& request);

struct FrameCapabilities {
  std::string name;  ///< description of the source, for people: "simulated camera", "/dev/video0 (vivid)"
  int width = 0;
  int height = 0;
  double rate_hz = 0.0;            ///< nominal
  bool knows_camera_pose = false;  ///< its frames carry T_robot_camera
};

struct FrameResult {
  SourceState state = SourceState::kWaiting;
  std::optional<Frame> frame;  ///< present only with kRunning
  /// kWaiting: the reason; empty while the next frame is only not due yet. kRunning: losses before this frame
  /// (an unreadable image); usually empty. kFinished: the name of the log.
  std::string message;
};

/// A camera. One consumer; *not* thread-safe unless an implementation says so, except that drivers let
/// another thread call stop(), which ends a waiting next() at once. test/contract tests the guarantees of
/// every implementation.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual FrameCapabilities capabilities() const = 0;
  virtual PortReply configure(const FrameRequest& request) = 0;
  virtual PortReply start() = 0;
  /// The next undelivered frame, the newest if several are available. Waits at most `timeout`, then returns
  /// kWaiting. Stamps and sequence numbers increase strictly, also over a restart.
  virtual FrameResult next(std::chrono::milliseconds timeout) = 0;
  /// next() returns kWaiting until the next start(). May be called twice.
  virtual void stop() = 0;
};

/// --- pan-tilt unit --------------------------------------------------------------------------------

struct PanTiltLimits {
  double min_pan_rad = 0.0;
  double max_pan_rad = 0.0;
  double min_tilt_rad = 0.0;
  double max_tilt_rad = 0.0;
  double max_pan_rate_radps = 0.0;
  double max_tilt_rate_radps = 0.0;
};

/// A command: a position with maximum rates (0: the unit's maximum), or a velocity that is held until the
/// next command.
struct PanTiltCommand {
  enum class Kind { kPosition, kVelocity };
  Kind kind = Kind::kVelocity;
  double pan_rad = 0.0;  ///< kPosition
  double tilt_rad = 0.0;
  double pan_rate_radps = 0.0;  ///< kVelocity: signed; kPosition: >= 0, upper bound
  double tilt_rate_radps = 0.0;
};

template <typename Sample>
struct SampleBatch {
  SourceState state = SourceState::kWaiting;
  std::vector<Sample> samples;  ///< oldest first, all newer than asked for
  std::string message;
};

/// A pan-tilt unit. *Thread-safe* but for lock-step implementations: it accepts commands and stop() while
/// other threads wait in samplesSince. test/contract/pantilt_contract.h tests the guarantees of every
/// implementation.
class PanTiltUnit {
 public:
  virtual ~PanTiltUnit() = default;
  /// Limits from the configuration are available before start(). Limits that the device reports may be all
  /// zero until it was reached.
  virtual PanTiltLimits limits() const = 0;
  /// Rejected only for permanent failures. A device that is away, or still finds its zero, gives "adjusted"
  /// with the reason. Until the device is ready, samplesSince and command return the reason while the driver
  /// keeps trying. May be called twice.
  virtual PortReply start() = 0;
  /// Angles and rates outside the limits are adjusted to them; values that are not finite are rejected
  /// (command_limits.h). Commands are rejected with the reason while the device is away, homes or is jammed.
  virtual PortReply command(const PanTiltCommand& command) = 0;
  /// Samples with stamp_us > after_us that the unit still holds (at least its last second), stamps and
  /// numbers strictly rising; waits at most `timeout` for one. kWaiting has the reason why there is none.
  virtual SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) = 0;
  /// Stops the unit and ends waits at once. A device's own driver rejects commands until the next start().
  /// May be called twice.
  virtual void stop() = 0;
};

/// --- mobile base ----------------------------------------------------------------------------------

struct BaseLimits {
  double max_speed_mps = 0.0;
  double max_turn_rate_radps = 0.0;
  double watchdog_s = 0.0;  ///< the base stops by itself this long after the last command
};

/// A base that drives and turns; threads and the other operations as in PanTiltUnit.
/// test/contract/mobile_base_contract.h tests the guarantees of every implementation.
class MobileBase {
 public:
  virtual ~MobileBase() = default;
  virtual BaseLimits limits() const = 0;
  virtual PortReply start() = 0;
  /// Valid until the next command, at most for limits().watchdog_s. The base then brakes by itself and stops,
  /// by default within 0.5 s of the last command from full speed. Speeds above the limits are adjusted to
  /// them; values that are not finite are rejected.
  virtual PortReply setVelocity(double v_mps, double w_radps) = 0;
  /// As PanTiltUnit::samplesSince.
  virtual SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) = 0;
  /// As PanTiltUnit::stop: the base brakes.
  virtual void stop() = 0;
};

/// A robot with stepped time: the simulator or a recorded log in lock-step, in one process.
/// `camera().next(0ms)` returns the frame just reached.
class SteppedRobot {
 public:
  virtual ~SteppedRobot() = default;
  /// Moves time to the next frame of the camera, and on until pan-tilt and odometry cover its stamp.
  /// @return false at the end of a log.
  virtual bool advanceToNextFrame() = 0;
  virtual FrameSource& camera() = 0;
  virtual PanTiltUnit& panTilt() = 0;
  virtual MobileBase& base() = 0;
};

}  // namespace vismem
