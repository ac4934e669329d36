/// @file Precision, recall and duplicates of remembered edges against the true ones. Pure. See E1, E4.
#pragma once

#include <cstdint>
#include <vector>

#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/floor_truth.h"

namespace vismem {

struct MemoryScoreParams {
  double end_m = 0.05;      ///< tolerance of an end across the viewing ray, and along it beside one pixel
  double focal_px = 277.1;  ///< focal length for the footprint of that pixel
  double angle_rad = 3.0 * 3.14159265358979323846 / 180.0;
  double found_share = 0.9;   ///< of a curve's seen length that must be remembered
  double resolved_px = 10.0;  ///< edges whose image was shorter in every view are also counted apart
  double gap_m = 0.06;        ///< longest unseen stretch inside a seen part of an edge
};

/// One remembered edge in world.
struct RememberedEdge {
  std::uint64_t id = 0;
  Segment2 world;
  Label label;
  bool confirmed = false;
};

struct MemoryScore {
  /// kRight: both ends are where an edge was last visible. kPartial: on a true edge, but an end is wrong.
  enum class Verdict { kRight, kPartial, kFalse };
  struct Judgement {
    RememberedEdge edge;
    Verdict verdict = Verdict::kFalse;
    int true_edge = -1;  ///< index of the edge it belongs to; -1: none
  };

  std::vector<Judgement> judged;  ///< the confirmed ones
  std::vector<int> missed;        ///< edges shown in full and not found
  int right = 0;
  int partial = 0;
  int wrong = 0;
  int unconfirmed = 0;
  int unconfirmed_on_edges = 0;
  int shown = 0;  ///< edges that some view showed in full
  int found = 0;  ///< of those
  int shown_resolved = 0;
  int found_resolved = 0;
  int edges_remembered = 0;  ///< edges with at least one element on them
  double on_edges = 0.0;     ///< elements on them; of a curve how often it is covered
  double right_m = 0.0;      ///< length of the right elements

  double precision() const { return judged.empty() ? 0.0 : static_cast<double>(right) / judged.size(); }
  double recall() const { return shown > 0 ? static_cast<double>(found) / shown : 0.0; }
  double recallResolved() const {
    return shown_resolved > 0 ? static_cast<double>(found_resolved) / shown_resolved : 0.0;
  }
  /// Elements per true edge that has any.
  double duplicates() const { return edges_remembered > 0 ? on_edges / edges_remembered : 0.0; }
};

/// Elements and edges are paired one-to-one, best first; further elements on an edge are duplicates.
/// A part of an edge is right when its ends are those of a visible part. Elements of a curve are right when
/// they lie on it.
MemoryScore scoreMemory(const std::vector<RememberedEdge>& memory, const std::vector<TrueEdge>& truth,
                        const MemoryScoreParams& params = {});

/// The memory in world, placed by the true pose of the robot (the memory is relative to the robot; see M6).
std::vector<RememberedEdge> rememberedIn(const MemorySnapshot& memory, const Pose2& T_world_robot);

}  // namespace vismem
