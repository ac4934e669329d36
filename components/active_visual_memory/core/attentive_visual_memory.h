/// @file The whole attentive visual memory as one machine: observation in, memory and gaze out. Pure.
/// SPEC M1-M10, V5, V6, A1-A6. Deterministic: the same observations and seed give the same results.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "active_visual_memory/core/attention.h"
#include "active_visual_memory/core/frame_gate.h"
#include "active_visual_memory/core/gaze_controller.h"
#include "active_visual_memory/core/ground_projector.h"
#include "active_visual_memory/core/primitive_memory.h"
#include "active_visual_memory/core/segment_memory.h"
#include "active_visual_memory/core/shape_edges.h"
#include "active_visual_memory/core/thin_lines.h"
#include "common/profiling/stage_probe.h"

namespace vismem {

struct AttentiveVisualMemoryParams {
  FrameGate::Params gate;
  ThinLineParams thin_lines;
  GroundProjector::Params projector;
  SegmentMemory::Params memory;
  PrimitiveMemory::Params primitives;
  ShapeEdges::Params shape_edges;
  KidnapDetector::Params kidnap;
  AttentionPool::Params attention;
  GazeController::Params gaze;

  /// The chapter's behaviour (SPEC): counters in ticks of 200 ms, newest orientation, every absence alike,
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
    bool kidnapped = false;                 ///< the memory was just set aside (M10)
    std::optional<PanTiltCommand> command;  ///< to give now; empty: nothing new to say
  };

  explicit AttentiveVisualMemory(const Params& params);

  /// V6: is this frame worth analysing? Then call step, else glance.
  bool wants(const RobotObservation& observation) const { return gate_.opens(observation); }

  /// One analysed image. @param observed all its segments, ideal pixels, also those above the horizon.
  /// @param probe hears of the stages "memory" and "gaze"; may be null.
  StepResult step(const RobotObservation& observation, const std::vector<ImageSegment>& observed,
                  StageProbe* probe = nullptr);
  /// A frame that is not analysed: time passes and the gaze goes on.
  StepResult glance(const RobotObservation& observation, StageProbe* probe = nullptr);

  /// What clients asked for urgently since the last image is answered before the next one.
  std::optional<PanTiltCommand> redirect();

  /// The images are gone for a while: what to tell the pan-tilt unit, once.
  std::optional<PanTiltCommand> imagesLost() { return gaze_.imagesLost(); }

  /// Sets the memory aside and begins anew.
  void reset();

  /// Requests of gaze clients; single-threaded like this class.
  GazeMailbox& gazeClient() { return mailbox_; }
  const std::vector<MemoryElement>& elements() const { return memory_.elements(); }
  std::uint32_t epoch() const { return epoch_; }
  /// How the camera leans beside what the kinematics say, as far as the images told.
  const Lean& lean() const { return memory_.lean(); }
  LeanCovariance leanCovariance() const { return memory_.leanCovariance(); }

 private:
  void followEpoch(const RobotObservation& observation);
  void readMail();
  double turnRate(const RobotObservation& observation);
  StepResult finish(const RobotObservation& observation, StageProbe* probe);

  Params params_;
  FrameGate gate_;
  GroundProjector projector_;
  SegmentMemory memory_;
  PrimitiveMemory primitives_;
  ShapeEdges shape_edges_;
  KidnapDetector kidnap_;
  AttentionPool pool_;
  GazeController gaze_;
  GazeMailbox mailbox_;
  std::uint32_t epoch_ = 0;
  std::optional<std::uint32_t> source_epoch_;
  std::uint64_t revision_ = 0;
  std::optional<Pose3> last_camera_;
  StampUs last_stamp_us_ = 0;
  MemoryUpdate last_update_;
};

}  // namespace vismem
