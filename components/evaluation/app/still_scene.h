/// @file What the camera of a simulated robot would see without the models that walk. See M1.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "evaluation/core/lockstep.h"
#include "evaluation/core/moving_edges.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"

namespace vismem {

/// Renders the images of a simulation again, without the models that have walked so far. *Single-threaded*;
/// the simulation must outlive it.
class StillScene {
 public:
  explicit StillScene(Simulation& simulation);

  /// Looks at a frame of Lockstep, whose exposure was the simulation's last one or the one before.
  void add(const LockstepFrame& frame);

  const MovingEdges& edges() const { return edges_; }

 private:
  /// Empty where the exposure is not known, or nothing has walked yet.
  std::optional<Frame> withoutWalkers(const Frame& frame);

  Simulation& simulation_;
  Renderer renderer_;
  SceneState shown_;
  std::map<std::uint64_t, ExposedFrame> exposures_;  ///< the newest, by number
  std::set<std::size_t> walkers_;                    ///< indices of models
  MovingEdges edges_;
};

}  // namespace vismem
