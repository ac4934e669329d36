/// @file Attention points, state of the gaze, and requests of gaze clients. Pure. See A1-A6.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/robot/ports.h"
#include "common/robot/samples.h"

namespace vismem {

enum class AttentionKind { kSegment, kPrimitive, kScanning, kHypothesis, kClient };

/// An attention point (A2): a place in odom or, for scanning points, a direction of the head.
struct AttentionPoint {
  std::uint64_t id = 0;
  AttentionKind kind = AttentionKind::kSegment;
  std::optional<Eigen::Vector3d> p_odom;  ///< [m]
  std::optional<PanTilt> direction;       ///< pan and tilt of the head, relative to the robot
  double salience = 0.0;
};

/// A5. The numbers are the chapter's.
enum class GazeState { kSelect = 0, kSaccade = 1, kAnalyse = 2, kTrack = 3 };

/// kAttend: salience decides. kFixate: keep looking at one point. kHold: keep the angles. kOff: no commands.
enum class GazeMode { kAttend, kFixate, kHold, kOff };

struct GazeStatus {
  StampUs stamp_us = 0;
  GazeMode mode = GazeMode::kAttend;
  GazeState state = GazeState::kSelect;
  std::optional<AttentionPoint> target;
  std::vector<AttentionPoint> points;
  std::uint64_t visits = 0;    ///< completed since start
  std::uint64_t given_up = 0;  ///< targets not reached in time (A6)
};

/// A request of at least this priority begins above all that no client asked for, and as the most salient
/// point it ends the visit of an object at once (what lies within that visit's angle was looked at with it).
inline constexpr double kUrgentPriority = 50.0;
/// No request has a higher one.
inline constexpr double kMaxPriority = 100.0;

/// A client's request: look at a place or a direction, more likely the higher the priority, until the
/// deadline.
struct GazeRequest {
  std::string client;  ///< name; a request of the same client and key replaces the older one
  std::string key;
  std::optional<Eigen::Vector3d> p_odom;
  std::optional<PanTilt> direction;
  double priority = 1.0;    ///< growth of salience relative to a remembered segment's, > 0, at most 100
  StampUs deadline_us = 0;  ///< forgotten after this stamp
};

/// The one check of gaze requests, for all ways they come. Fields are named as on the wire.
/// @return empty if usable, otherwise field, value and rule: an empty client, names of more than 100
/// characters, not exactly one of place and direction, numbers that are not finite, a priority outside
/// (0, 100].
std::string checkGazeRequest(const GazeRequest& request);
/// The same of the names alone, and of a place [m].
std::string checkGazeClient(const std::string& client, const std::string& key);
std::string checkGazePlace(const Eigen::Vector3d& p_odom);

/// The port of gaze clients: the local component, or the client of a remote one.
class GazeClient {
 public:
  virtual ~GazeClient() = default;
  virtual PortReply setMode(GazeMode mode) = 0;
  virtual PortReply fixate(const Eigen::Vector3d& p_odom) = 0;
  virtual PortReply request(const GazeRequest& request) = 0;
  virtual PortReply withdraw(const std::string& client, const std::string& key) = 0;
  virtual std::optional<GazeStatus> status() = 0;
};

}  // namespace vismem
