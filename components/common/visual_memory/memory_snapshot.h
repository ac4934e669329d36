/// @file Published values of the visual memory, immutable, and the port to them. Pure. See V5, M4.
/// The component active_visual_memory produces them; localization, recorder and viewers consume them.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/segment.h"
#include "common/robot/ports.h"
#include "common/robot/samples.h"
#include "common/vision/image_segment.h"
#include "common/visual_memory/primitive.h"

namespace vismem {

/// One remembered segment. Positions in odom [m].
struct MemorySegment {
  std::uint64_t id = 0;  ///< never used twice in a component's life; 0 is none
  Segment3 odom;
  Eigen::Matrix3d P_a = Eigen::Matrix3d::Zero();  ///< covariance of end a [m^2]
  Eigen::Matrix3d P_b = Eigen::Matrix3d::Zero();
  Label label = kUnknownLabel;
  double life = 0.0;         ///< 0..maximum (M4)
  double uncertainty = 0.0;  ///< 1 / life (M4)
  double salience = 0.0;     ///< A1
  bool confirmed = false;    ///< seen at the same floor place from a second viewpoint (M1)
  bool off_floor = false;    ///< its floor place moves with the camera, or by itself: it shows no edge there
  StampUs first_seen_us = 0;
  StampUs last_seen_us = 0;
};

/// The whole memory after one iteration.
struct MemorySnapshot {
  StampUs stamp_us = 0;        ///< of the image it includes
  std::uint64_t revision = 0;  ///< counts up by one per iteration
  std::uint32_t epoch = 0;     ///< counts up when the memory was dropped and begun anew
  Pose2 T_odom_robot;          ///< at stamp_us
  std::vector<MemorySegment> segments;
  std::vector<Primitive> primitives;         ///< shapes made of the segments (M8), oldest first
  std::vector<VertexHypothesis> hypotheses;  ///< corners of them to look for (M9)
};

/// Prediction for an image: the visible part of a remembered segment.
struct PredictedSegment {
  std::uint64_t id = 0;
  Segment2 px;  ///< ideal pixels
  Label label = kUnknownLabel;
  bool off_floor = false;  ///< of the remembered segment
};

/// The 2-D side of one iteration (V5): matched, predicted but not observed, observed but not predicted.
struct ImageAnalysis {
  StampUs stamp_us = 0;
  std::uint64_t frame_seq = 0;
  CameraIntrinsics intrinsics;
  Pose2 T_odom_robot;
  Pose3 T_robot_camera = Pose3::Identity();
  std::vector<ImageSegment> observed;  ///< all segments, also those above the horizon
  std::vector<PredictedSegment> predicted;
  struct Match {
    int observed = 0;   ///< index into `observed`
    int predicted = 0;  ///< index into `predicted`
  };
  std::vector<Match> matches;  ///< one-to-one
};

struct MemoryUpdate {
  std::shared_ptr<const MemorySnapshot> snapshot;
  std::shared_ptr<const ImageAnalysis> analysis;
};

struct MemoryResult {
  SourceState state = SourceState::kWaiting;
  MemoryUpdate update;  ///< both pointers set with kRunning
  std::string message;
};

/// The port of the memory's consumers: the local component in lock-step, or the client of a remote one.
class VisualMemorySource {
 public:
  virtual ~VisualMemorySource() = default;
  /// The newest update with a revision above `after_revision`; waits at most `timeout`.
  virtual MemoryResult next(std::uint64_t after_revision, std::chrono::milliseconds timeout) = 0;
};

}  // namespace vismem
