/// @file The attentive visual memory as one machine: observation in, memory and gaze out. Pure. See M1-M10,
/// V5, V6, A1-A6. Deterministic: the same observations and seed give the same results.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "active_visual_memory/core/frame_gate.h"
#include "active_visual_memory/core/gaze/attention.h"
#include "active_visual_memory/core/gaze/gaze_controller.h"
#include "active_visual_memory/core/gaze/gaze_requests.h"
#include "active_visual_memory/core/ground/ground_projector.h"
#include "active_visual_memory/core/markings/shape_edges.h"
#include "active_visual_memory/core/memory/segment_memory.h"
#include "active_visual_memory/core/primitives/primitive_tracker.h"
#include "common/config/parameter_visitor.h"
#include "common/memory/scratch.h"
#include "common/memory/snapshots.h"
#include "common/profiling/stage_probe.h"
#include "common/robot/rig.h"

namespace vismem {

struct AttentiveVisualMemoryParams {
  Rig rig;
  FrameGate::Params gate;
  GroundProjector::Params projector;
  SegmentMemory::Params memory;
  PrimitiveTracker::Params primitives;
  ShapeEdges::Params shape_edges;
  KidnapDetector::Params kidnap;
  AttentionPool::Params attention;
  GazeController::Params gaze;

  /// Declares the keys of all parts but the mount.
  void visit(ParameterVisitor& v);

  /// The chapter's behaviour: counters in ticks of 200 ms, newest orientation, every absence alike,
  /// no confirmation, proportional controllers, 3 s per object, scanning over the whole range.
  static AttentiveVisualMemoryParams chapter();
  /// Ours.
  static AttentiveVisualMemoryParams standard();
};

/// *Single-threaded* (owner: the perception loop). Invariant: revisions count up by one per analysed image.
class AttentiveVisualMemory {
 public:
  using Params = AttentiveVisualMemoryParams;

  struct StepResult {
    MemoryUpdate update;  ///< both pointers set; the last one again for a frame that was not analysed
    GazeStatus gaze;
    bool kidnapped = false;                 ///< the memory was dropped with this image (M10)
    std::optional<PanTiltCommand> command;  ///< the next command; empty: nothing new
  };

  explicit AttentiveVisualMemory(const Params& params);

  /// Whether this frame is to be analysed (V6): then call update(), else predict().
  bool wants(const RobotObservation& observation) const { return gate_.opens(observation); }

  /// Processes an analysed image.
  /// @param observed  all its segments, ideal pixels, also those above the horizon.
  /// @param probe     is notified of the stages "memory" and "gaze"; may be null.
  /// @return until the next step.
  const StepResult& update(const RobotObservation& observation, const std::vector<ImageSegment>& observed,
                           StageProbe* probe = nullptr);
  /// Advances time by a frame that is not analysed; the gaze goes on.
  /// @return until the next step.
  const StepResult& predict(const RobotObservation& observation, StageProbe* probe = nullptr);

  /// Serves urgent requests between two images.
  std::optional<PanTiltCommand> preempt();

  /// Images are lost. @return the command that holds the head, once.
  std::optional<PanTiltCommand> imagesLost() { return gaze_.imagesLost(); }

  /// Drops the memory and begins a new epoch.
  void reset();

  /// Requests of gaze clients; single-threaded like this class.
  GazeRequestQueue& gazeClient() { return gaze_requests_; }
  /// For changes of its rates between two images.
  AttentionPool& attention() { return pool_; }
  const std::vector<MemoryElement>& elements() const { return memory_.elements(); }
  /// Estimated extrinsic rotation error of the camera.
  const CameraTilt& cameraTilt() const { return memory_.cameraTilt(); }
  CameraTiltCovariance cameraTiltCovariance() const { return memory_.cameraTiltCovariance(); }

 private:
  /// Begins a step; a new epoch of the observations drops the memory. @return turn rate of the camera
  /// [rad/s].
  double begin(const RobotObservation& observation, StageProbe* probe);
  void readGazeRequests();
  double turnRate(const RobotObservation& observation);
  /// Shapes, gaze and, after an image that was analysed, the new snapshot. Sets `result_`.
  void finish(const RobotObservation& observation, StageProbe* probe);
  void publish(const RobotObservation& observation);

  Params params_;
  FrameGate gate_;
  GroundProjector projector_;
  SegmentMemory memory_;
  PrimitiveTracker primitives_;
  ShapeEdges shape_edges_;
  KidnapDetector kidnap_;
  AttentionPool pool_;
  GazeController gaze_;
  GazeRequestQueue gaze_requests_;
  std::uint32_t epoch_ = 0;
  std::optional<std::uint32_t> source_epoch_;
  std::uint64_t revision_ = 0;
  std::optional<Pose3> last_camera_;
  StampUs last_stamp_us_ = 0;
  StepResult result_;  ///< of the last step
  Snapshots<MemorySnapshot> snapshots_;
  Snapshots<ImageAnalysis> analyses_;
  std::vector<MemorySegment> segments_;       ///< to be published
  std::vector<Primitive> shapes_;             ///< the same
  std::vector<VertexHypothesis> hypotheses_;  ///< the same
  Scratch scratch_;                           ///< of one image
};

}  // namespace vismem
