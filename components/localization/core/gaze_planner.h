/// @file When localization asks for gaze, for what, and when it has seen enough. Pure. SPEC B4, A6; DESIGN 9.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/visual_memory/gaze.h"
#include "localization/core/gaze_advisor.h"

namespace vismem {

/// What to tell a GazeClient now; first take back, then ask.
struct GazePlan {
  std::vector<std::string> withdrawn;  ///< keys
  std::vector<GazeRequest> requests;

  bool isEmpty() const { return withdrawn.empty() && requests.empty(); }
};

/// The name under which localization asks.
inline constexpr const char* kGazeClientName = "localization";

/// Tells a client all of a plan. @return how many of its parts were rejected.
int carryOut(const GazePlan& plan, GazeClient& client);

/// Turns races into one wish, which it moves whenever another direction promises more, also on the way;
/// nothing while the pose is sure, so that salience and other clients have the camera.
/// Invariant: at most one wish stands; it has a deadline, so that it outlives nobody.
/// *Single-threaded* (owner: the component's loop).
class GazePlanner {
 public:
  /// @param localizer and @param map_edges of the Localizer whose estimates are given to plan().
  GazePlanner(const GazePlannerParams& params, const LocalizerParams& localizer, const SegmentMap& map_edges);

  /// To be called with every update. @param estimate what the Localizer made of it.
  GazePlan plan(const PoseEstimate& estimate, const MemoryUpdate& update);

  /// How much a look could help, 0 (the pose is sure) .. 1 (nothing is known).
  static double doubt(const PoseEstimate& estimate);
  /// What is asked for now.
  std::optional<GazeAdvice> wish() const;

 private:
  struct Wish {
    std::string key;
    GazeAdvice advice;
    StampUs asked_us = 0;    ///< last
    StampUs reached_us = 0;  ///< the camera was there last, or was asked there since
  };
  void noteAxis(const MemoryUpdate& update);

  GazePlannerParams params_;
  GazeAdvisor advisor_;
  std::optional<Wish> wish_;
  std::optional<StampUs> doubted_us_;  ///< last; empty: there is no doubt
  std::uint32_t epoch_ = 0;
  StampUs last_stamp_us_ = 0;
  std::uint64_t asked_ = 0;
};

}  // namespace vismem
