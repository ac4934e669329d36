/// @file The three ports of a robot. Drivers, the simulator, the replay of a log and the Ice clients of
/// remote servers all implement them; everything above is written against them alone (DESIGN 2).
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

/// How a source answered a request: taken as asked, changed (to what `message` says), or refused (why).
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
  kWaiting,   ///< nothing yet, or the peer or device is away; `message` says for what; ask again
  kFinished,  ///< the end of a log: nothing more comes unless it is rewound
};

/// --- camera ---------------------------------------------------------------------------------------

struct FrameRequest {
  int width = 0;         ///< 0: the source's own choice
  int height = 0;        ///< 0: the source's own choice
  double rate_hz = 0.0;  ///< 0: the source's own choice
  /// The consumer can do with Frame::native in place of pixels (a server that passes JPEG on does).
  bool accept_native = false;
};

/// Images larger than this on a side are absurd, and so are rates outside these.
constexpr int kMaxImageSide_px = 16384;
constexpr double kMinFrameRate_hz = 0.001;
constexpr double kMaxFrameRate_hz = 10'000.0;

/// @return a rejection that names value and rule for a request that makes no sense with any source: negative
/// or huge sizes, rates that are negative, not finite or absurd. Every implementation asks this first.
std::optional<PortReply> rejectAbsurd(const FrameRequest& request);

struct FrameCapabilities {
  std::string name;  ///< what the source is, for people: "simulated camera", "/dev/video0 (vivid)"
  int width = 0;
  int height = 0;
  double rate_hz = 0.0;            ///< nominal
  bool knows_camera_pose = false;  ///< its frames carry T_robot_camera
};

struct FrameResult {
  SourceState state = SourceState::kWaiting;
  std::optional<Frame> frame;  ///< present only with kRunning
  /// kWaiting: why; a driver leaves it empty while all is well and only no frame fell due yet. kRunning: what
  /// was lost on the way to this frame (a picture that could not be read); usually empty. kFinished: the end
  /// of what.
  std::string message;
};

/// A camera. One consumer; *not* thread-safe unless an implementation says so, except that drivers let
/// another thread call stop(), which ends a waiting next() at once. test/contract holds what every
/// implementation promises.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual FrameCapabilities capabilities() const = 0;
  virtual PortReply configure(const FrameRequest& request) = 0;
  virtual PortReply start() = 0;
  /// The next frame not yet delivered, the newest if several are waiting (latest wins). Waits at most
  /// `timeout`; kWaiting when none came. Stamps and sequence numbers rise from start() to stop(), and over a
  /// restart.
  virtual FrameResult next(std::chrono::milliseconds timeout) = 0;
  /// next() then gives kWaiting until start() is called again. May be called twice.
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

/// A command: either a position to reach (rates bound the way there; 0 = the unit's maximum) or a velocity
/// to hold until the next command.
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

/// A pan-tilt unit. *Thread-safe* but for lock-step implementations: commands are taken, and stop() is, while
/// other threads wait in samplesSince. test/contract/pantilt_contract.h holds what every implementation
/// promises.
class PanTiltUnit {
 public:
  virtual ~PanTiltUnit() = default;
  /// A driver knows them before start(), from its configuration; those of a device that tells its own may be
  /// all zero before it was reached.
  virtual PanTiltLimits limits() const = 0;
  /// Rejected only for what cannot come right by itself. A device that is away, or still finds its zero, is
  /// "adjusted" with what is waited for; samplesSince and command then say so until it is there, and the
  /// driver keeps trying. May be called twice.
  virtual PortReply start() = 0;
  /// Angles and rates outside the limits are adjusted to them; values that are not finite are rejected
  /// (command_limits.h has the rule). Rejected with the reason while the device is away, homes or is jammed.
  virtual PortReply command(const PanTiltCommand& command) = 0;
  /// Samples with stamp_us > after_us that the unit still holds (at least its last second), stamps and
  /// numbers strictly rising; waits at most `timeout` for one. kWaiting says why there is none.
  virtual SampleBatch<PanTiltSample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) = 0;
  /// The unit stands, waits end at once, and commands of a device's own driver are rejected until start(),
  /// which begins anew. May be called twice.
  virtual void stop() = 0;
};

/// --- mobile base ----------------------------------------------------------------------------------

struct BaseLimits {
  double max_speed_mps = 0.0;
  double max_turn_rate_radps = 0.0;
  double watchdog_s = 0.0;  ///< the base stops by itself when no command came for this long
};

/// A base that drives and turns; threads and the other operations as in PanTiltUnit.
/// test/contract/mobile_base_contract.h holds what every implementation promises.
class MobileBase {
 public:
  virtual ~MobileBase() = default;
  virtual BaseLimits limits() const = 0;
  virtual PortReply start() = 0;
  /// Holds until the next command, or for limits().watchdog_s: then the base brakes by itself and stands, by
  /// default within 0.5 s of the last command from full speed. Speeds above the limits are adjusted to them;
  /// values that are not finite are rejected.
  virtual PortReply setVelocity(double v_mps, double w_radps) = 0;
  /// As PanTiltUnit::samplesSince.
  virtual SampleBatch<OdometrySample> samplesSince(StampUs after_us, std::chrono::milliseconds timeout) = 0;
  /// As PanTiltUnit::stop: the base brakes.
  virtual void stop() = 0;
};

/// A whole robot whose time moves only when told to: the simulator or a recorded log in lock-step, in one
/// process. `camera().next(0ms)` then gives the frame just reached.
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
